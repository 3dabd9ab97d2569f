#include "pendcore/integrate/root.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pendcore {
namespace {

constexpr double none = 2.0;
using Bernstein = std::array<double, 16>;

double value(const double* c, int degree, double theta) {
  double sum = c[degree];
  for (int k = degree - 1; k >= 0; --k) sum = sum * theta + c[k];
  return sum;
}

/// 1/C(degree, k)
constexpr std::array<Bernstein, 16> inverse_binomials = [] {
  std::array<Bernstein, 16> table{};
  for (int degree = 0; degree < 16; ++degree) {
    double binomial = 1.0;
    for (int k = 0; k <= degree; ++k) {
      table[degree][k] = 1.0 / binomial;
      binomial = binomial * (degree - k) / (k + 1);
    }
  }
  return table;
}();

/// The coefficients on [0, 1]: b_i = sum_{k <= i} C(i, k)/C(degree, k) c_k, by Pascal's triangle.
Bernstein bernstein(const double* c, int degree) {
  Bernstein b{};
  for (int k = 0; k <= degree; ++k) b[k] = inverse_binomials[degree][k] * c[k];
  for (int k = 1; k <= degree; ++k) {
    for (int i = degree; i >= k; --i) b[i] += b[i - 1];
  }
  return b;
}

/// A sign change between low and high, p(low) >= 0 > p(high), to the last bits of theta.
double bisect(const double* c, int degree, double low, double high) {
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return high;
    (value(c, degree, middle) < 0.0 ? high : low) = middle;
  }
}

double search(const double* c, int degree, const Bernstein& b, double low, double high, int depth) {
  bool any_negative = false;
  for (int i = 0; i <= degree; ++i) any_negative |= b[i] < 0.0;
  if (!any_negative) return none;
  int changes = 0;
  for (int i = 1; i <= degree; ++i) changes += (b[i] < 0.0) != (b[i - 1] < 0.0);
  if (changes == 0) return low;
  if (changes == 1 && b[0] >= 0.0) return bisect(c, degree, low, high);
  if (depth == 50) return value(c, degree, high) < 0.0 ? high : none;  // touches zero, no more
  // de Casteljau: both halves
  Bernstein left{};
  Bernstein right = b;
  for (int i = 0; i <= degree; ++i) {
    left[i] = right[0];
    for (int k = 0; k < degree - i; ++k) right[k] = 0.5 * (right[k] + right[k + 1]);
  }
  const double middle = 0.5 * (low + high);
  const double found = search(c, degree, left, low, middle, depth + 1);
  return found <= 1.0 ? found : search(c, degree, right, middle, high, depth + 1);
}

}  // namespace

double first_negative(const double* coefficients, int degree) {
  double least = coefficients[0];  // a bound
  for (int k = 1; k <= degree; ++k) least += std::min(coefficients[k], 0.0);
  if (least > 0.0) return none;
  double largest = 0.0;
  for (int k = 1; k <= degree; ++k) largest = std::max(largest, std::abs(coefficients[k]));
  const bool from_zero = coefficients[0] <= 1e-13 * largest;
  const double* const c = from_zero ? coefficients + 1 : coefficients;  // p/theta has p's signs
  const int rest = from_zero ? degree - 1 : degree;
  if (!(largest > 0.0)) return coefficients[0] < 0.0 ? 0.0 : none;
  return search(c, rest, bernstein(c, rest), 0.0, 1.0, 0);
}

double first_negative(const std::function<double(double)>& f, int samples) {
  double low = 0.0;
  for (int i = 1; i <= samples; ++i) {
    double high = static_cast<double>(i) / samples;
    if (f(high) < 0.0) {
      while (true) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) return high;
        (f(middle) < 0.0 ? high : low) = middle;
      }
    }
    low = high;
  }
  return none;
}

}  // namespace pendcore
