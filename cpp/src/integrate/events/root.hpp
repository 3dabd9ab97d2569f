/// \file
/// Root location: where a function first becomes negative in 0 < theta <= 1, or all its zeros
/// there.
///
/// The roots of a polynomial are isolated in Bernstein form. No sign change among its coefficients
/// b_i on an interval means no root, and one sign change means one root. Otherwise the interval is
/// halved, so that two roots close together are both found.
///
/// To find all zeros, the turning points are taken in order: between two neighbours the function is
/// monotone or has no zero. The turning points of a polynomial are the roots of its derivative. A
/// value at a turning point that is within the noise of rounding is a zero that the function
/// touches.
///
/// Source: Lane and Riesenfeld, BIT 21 (1981) 112. Cost: 20 operations where there is no root.
#pragma once

#include <cmath>
#include <vector>

namespace pendcore {

/// The least theta in (0, 1] from which p(theta) = sum_k coefficients[k] theta^k is negative, to
/// the last bits; above 1 if there is none. At 0 the function must be positive, or have just been
/// zero: a value there that is below 1e-13 of the other coefficients counts as zero, and the result
/// is where the polynomial becomes negative next.
double first_negative(const double* coefficients, int degree);

inline constexpr int highest_degree = 63;  ///< the highest degree of all polynomials here

/// The coefficients of the Bernstein form on [0, 1], (degree + 1). The polynomial lies between the
/// least and the largest of them.
void bernstein_form(const double* coefficients, int degree, double* bernstein);

/// A zero in 0 < theta <= 1. Direction 1: the function rises through it; -1: it falls; 0: it
/// touches zero and turns back.
struct Root {
  double theta;
  int direction;
};

struct TurningPoint {
  double theta;
  double value;
};

/// Adds the turning points of p(theta) = sum_k coefficients[k] theta^k in 0 < theta < 1, in their
/// order.
void find_turning_points(const double* coefficients, int degree, std::vector<TurningPoint>& found);

/// sum_k coefficients[k] theta^k
inline double polynomial_at(const double* coefficients, int degree, double theta) {
  double value = coefficients[degree];
  for (int k = degree - 1; k >= 0; --k) value = value * theta + coefficients[k];
  return value;
}

inline int sign(double x) { return (x > 0.0) - (x < 0.0); }

/// Where f takes the sign `after`, which it has at `high` and not at `low`; to the last bits.
template <class Function>
double bisect(const Function& f, double low, double high, int after) {
  while (high - low > 0x1p-54) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    const int here = sign(f(middle));
    if (here == 0) return middle;
    (here == after ? high : low) = middle;
  }
  return high;
}

/// Adds the zeros of f in 0 < theta <= 1 to `found`, in their order. At the ends, the values
/// `start` and `end` replace what f computes, so that two neighbouring steps agree on the sign
/// between them. A zero at 0 does not count, and one at 1 does. Values up to `noise` at a turning
/// point count as zero. Returns whether f has left the zero in which it starts, at the last turning
/// point at the latest; true if it does not start in one.
template <class Function>
bool find_roots(const Function& f, double start, const std::vector<TurningPoint>& turning_points,
                double end, double noise, std::vector<Root>& found) {
  int side = sign(start);  // 0 until f leaves the zero where it starts
  double low = 0.0;
  TurningPoint touch{2.0, 0.0};
  for (const TurningPoint& point : turning_points) {
    const int here = std::abs(point.value) <= noise ? 0 : sign(point.value);
    if (here == 0) {
      const bool nearer = touch.theta > 1.0 || std::abs(point.value) < std::abs(touch.value);
      if (side != 0 && nearer) touch = point;
      continue;
    }
    if (touch.theta <= 1.0) {
      found.push_back({touch.theta, here == side ? 0 : here});
    } else if (side == -here) {
      found.push_back({bisect(f, low, point.theta, here), here});
    }
    touch.theta = 2.0;
    side = here;
    low = point.theta;
  }
  const int here = sign(end);
  if (side == 0) return false;
  if (touch.theta <= 1.0) {
    found.push_back({touch.theta, here == side ? 0 : -side});
  } else if (here == 0) {
    found.push_back({1.0, -side});
  } else if (here != side) {
    found.push_back({bisect(f, low, 1.0, here), here});
  }
  return true;
}

/// The same for p(theta) = sum_k coefficients[k] theta^k, with the value `end` at 1.
bool find_roots(const double* coefficients, int degree, double end, double noise,
                std::vector<Root>& found);

}  // namespace pendcore
