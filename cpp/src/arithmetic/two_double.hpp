/// \file
/// A number carried as the unevaluated sum of two doubles: about 106 bits.
///
/// Time is kept in this form: ten million rounded additions of 0.1 miss a million by 1.6e-4, and a
/// step below the last bit of t would be lost. The sums are from Knuth, The Art of Computer
/// Programming, volume 2, section 4.2.2 (TwoSum) and Dekker (1971).
#pragma once

#include <type_traits>

#include "arithmetic/instruction_set.hpp"

namespace pendcore {

/// `Real` is a double, or a pack with a sum in each lane.
template <class Real>
struct TwoNumbers {
  Real high{};  ///< the sum, rounded to a double
  Real low{};   ///< the rounding error of `high`
};
using TwoDouble = TwoNumbers<double>;

/// a + b - sum, exactly, where sum is a + b rounded.
template <class Real>
PENDCORE_INLINE constexpr Real left_over(const Real& a, const Real& b, const Real& sum) {
  const Real b_part = sum - a;
  return (a - (sum - b_part)) + (b - b_part);
}

/// a b - product, exactly, where product is a b rounded; not where a part overflows, or is below
/// the least double. Halves of the factors have exact products (Dekker 1971).
template <class Real>
PENDCORE_INLINE constexpr Real product_error(const Real& a, const Real& b, const Real& product) {
  constexpr double splitter = 0x1p27 + 1;
  const Real a_high = splitter * a - (splitter * a - a);
  const Real b_high = splitter * b - (splitter * b - b);
  const Real a_low = a - a_high;
  const Real b_low = b - b_high;
  return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

template <class Real>
PENDCORE_INLINE constexpr TwoNumbers<Real> two_sum(const Real& a, const Real& b) {
  const Real sum = a + b;
  return {sum, left_over(a, b, sum)};
}

template <class Real>
PENDCORE_INLINE constexpr TwoNumbers<Real> operator+(const TwoNumbers<Real>& a,
                                                     const std::type_identity_t<Real>& b) {
  const TwoNumbers<Real> sum = two_sum(a.high, b);
  return two_sum(sum.high, Real(sum.low + a.low));
}

PENDCORE_INLINE constexpr TwoDouble operator+(const TwoDouble& a, const TwoDouble& b) {
  const TwoDouble sum = two_sum(a.high, b.high);
  return two_sum(sum.high, sum.low + (a.low + b.low));
}
PENDCORE_INLINE constexpr TwoDouble operator*(const TwoDouble& a, double b) {
  const double product = a.high * b;
  return two_sum(product, product_error(a.high, b, product) + a.low * b);
}

/// b - a, rounded to a double.
template <class Real>
PENDCORE_INLINE constexpr Real difference(const std::type_identity_t<Real>& b,
                                          const TwoNumbers<Real>& a) {
  const TwoNumbers<Real> sum = two_sum(b, Real(-a.high));
  return sum.high + (sum.low - a.low);
}

}  // namespace pendcore
