/// \file
/// THE ROOT LOCATOR: where a function first turns negative in 0 < theta <= 1, or all zeros there.
///
/// A polynomial is isolated in Bernstein's form: with coefficients b_i on an interval, no sign
/// change among them means no root, one means one root; halving the interval separates the rest, so
/// that two roots close together are both seen.
///
/// All zeros are found by a walk along turning points: between two of them in a row the function is
/// monotone or has no zero. Those of a polynomial are the roots of its derivative. What lies within
/// the noise of rounding at a turning point is a zero that the function touches.
///
/// Source: Lane and Riesenfeld, BIT 21 (1981) 112. Cost: 20 operations where there is no root.
#pragma once

#include <cmath>
#include <vector>

namespace pendcore {

/// The least theta in (0, 1] from which p(theta) = sum_k coefficients[k] theta^k is negative, to
/// the last bits; above 1 if there is none. What is called begins where the function is positive or
/// has just been zero: a value at 0 that is below 1e-13 of the other coefficients counts as zero,
/// and the polynomial turns negative where it does so next. Degree at most 35.
double first_negative(const double* coefficients, int degree);

inline constexpr int highest_degree = 63;  ///< of a polynomial whose zeros are asked for

/// The coefficients of Bernstein's form on [0, 1]: (degree + 1). The polynomial lies between the
/// least and the largest of them.
void bernstein_form(const double* coefficients, int degree, double* bernstein);

/// A zero in 0 < theta <= 1. Direction 1: rises through it; -1: falls; 0: touches and turns back.
struct Root {
  double theta;
  int direction;
};

struct TurningPoint {
  double theta;
  double value;
};

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

/// The zeros of f in 0 < theta <= 1, in their order, added to `found`. At the ends f is what is
/// given as `start` and `end`, whatever it computes there, so that two steps that meet agree on the
/// sign between them. A zero at 0 is none, and one at 1 is; values up to `noise` at a turning point
/// count as zero.
template <class Function>
void find_roots(const Function& f, double start, const std::vector<TurningPoint>& turning_points,
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
  if (side == 0) return;
  if (touch.theta <= 1.0) {
    found.push_back({touch.theta, here == side ? 0 : -side});
  } else if (here == 0) {
    found.push_back({1.0, -side});
  } else if (here != side) {
    found.push_back({bisect(f, low, 1.0, here), here});
  }
}

/// The same of p(theta) = sum_k coefficients[k] theta^k, which is `end` at 1. Degree up to 63.
void find_roots(const double* coefficients, int degree, double end, double noise,
                std::vector<Root>& found);

}  // namespace pendcore
