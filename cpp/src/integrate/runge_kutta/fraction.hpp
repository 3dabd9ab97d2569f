/// \file
/// An exact number of Q(sqrt(6)), and the double nearest to it:
///
///     (numerator + root sqrt(6)) / denominator
///
/// Coefficients of methods are such numbers. Those with numerator and denominator below 2^53 and no
/// root are one division of doubles. For the others every operation works on sums of two doubles,
/// some 100 bits (Dekker 1971, Numerische Mathematik 18), and the result is rounded once. So a
/// coefficient is the same double for every compiler and processor, whatever their long double is.
///
/// Cost: nothing, because tables of coefficients are constants.
#pragma once

#include "arithmetic/two_double.hpp"

namespace pendcore {

namespace fraction_detail {

constexpr TwoDouble sqrt_6 = {0x1.3988e1409212ep+1, 0x1.f40c86450c869p-53};

constexpr TwoDouble two_doubles(long long n) {
  constexpr long long word = 1LL << 32;
  const long long high = n / word;
  return two_sum(static_cast<double>(high) * static_cast<double>(word),
                 static_cast<double>(n - high * word));
}

/// a b, exactly, unless it overflows.
constexpr TwoDouble product(double a, double b) {
  const double high = a * b;
  return {high, product_error(a, b, high)};
}

constexpr TwoDouble product(const TwoDouble& a, const TwoDouble& b) {
  const TwoDouble exact = product(a.high, b.high);
  return two_sum(exact.high, exact.low + (a.high * b.low + a.low * b.high));
}

constexpr TwoDouble sum(const TwoDouble& a, const TwoDouble& b) {
  const TwoDouble high = two_sum(a.high, b.high);
  const TwoDouble low = two_sum(a.low, b.low);
  const TwoDouble most = two_sum(high.high, high.low + low.high);
  return two_sum(most.high, most.low + low.low);
}

constexpr double quotient(TwoDouble a, const TwoDouble& b) {
  const double first = a.high / b.high;
  a = sum(a, product({-first, 0.0}, b));
  const double second = a.high / b.high;
  a = sum(a, product({-second, 0.0}, b));
  const TwoDouble both = two_sum(first, second);
  return both.high + (both.low + a.high / b.high);
}

/// The double nearest to (numerator + root sqrt(6)) / denominator.
constexpr double nearest(long long numerator, long long denominator, long long root) {
  constexpr long long exact = 1LL << 53;
  if (root == 0 && -exact < numerator && numerator < exact && denominator < exact) {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
  const TwoDouble top = sum(two_doubles(numerator), product(two_doubles(root), sqrt_6));
  return quotient(top, two_doubles(denominator));
}

}  // namespace fraction_detail

struct Fraction {
  long long numerator;
  long long denominator;  ///< > 0
  long long root;         ///< factor of sqrt(6)
  double value;           ///< the nearest double

  constexpr Fraction(long long top = 0, long long bottom = 1, long long factor = 0)
      : numerator(top),
        denominator(bottom),
        root(factor),
        value(fraction_detail::nearest(top, bottom, factor)) {}
  constexpr bool is_zero() const { return numerator == 0 && root == 0; }
};

}  // namespace pendcore
