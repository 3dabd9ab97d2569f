/// \file
/// a b + c, rounded once, from sums and products alone.
///
/// Source: Boldo & Melquiond, IEEE Transactions on Computers 57 (2008) 462. The product and both
/// sums are split exactly into two doubles each (Dekker; Knuth). The two small parts are added with
/// rounding to odd, which keeps what the last rounding has to know. Where a part could overflow or
/// lose bits below the least double, the C library computes the result from integers.
#pragma once

#include <bit>
#include <cmath>

#include "arithmetic/pack.hpp"
#include "arithmetic/two_double.hpp"

namespace pendcore {
namespace emulated_fma_detail {

template <class Real>
using Integers = typename Lanes<Real>::Integers;

/// x + y, rounded to odd: of the two doubles around an inexact sum, the one whose last bit is 1.
template <class Real>
PENDCORE_INLINE Real sum_to_odd(const Real& x, const Real& y) {
  const Real sum = x + y;
  const Real error = left_over(x, y, sum);
  const auto bits = std::bit_cast<Integers<Real>>(sum);
  // One bit away from zero where the error has the sign of the sum, else towards it.
  const Integers<Real> next = ((bits ^ std::bit_cast<Integers<Real>>(error)) >> 63) | 1;
  const Integers<Real> step = error != Real{} ? next : Integers<Real>{};
  return std::bit_cast<Real>(Integers<Real>(bits + step * (1 - (bits & 1))));
}

/// Whether no part of a b + c overflows, and none is below the least double.
inline bool is_far_from_limits(double a, double b, double c) {
  const auto exponent = [](double x) {
    return static_cast<int>(std::bit_cast<unsigned long long>(x) >> 52) & 0x7ff;
  };
  constexpr int bias = 1023;
  const int of_a = exponent(a), of_b = exponent(b);
  const int of_product = of_a + of_b - 2 * bias;
  return of_a > 0 && of_b > 0 && of_a < bias + 990 && of_b < bias + 990 && of_product > -960 &&
         of_product < 1000 && exponent(c) < bias + 1000;
}

/// Where a part could leave the range. The C library musl adds c = 0 to a product that is already
/// rounded, which loses the sign of one below the least double.
inline double near_limits(double a, double b, double c) {
  return c == 0.0 && a != 0.0 && b != 0.0 ? a * b : std::fma(a, b, c);
}

}  // namespace emulated_fma_detail

template <class Real>
PENDCORE_INLINE Real emulated_fma(const Real& a, const Real& b, const Real& c) {
  namespace detail = emulated_fma_detail;
  constexpr int width = Lanes<Real>::width;
  const Real product = a * b;
  const Real low = product_error(a, b, product);
  const Real inner = c + low;
  const Real outer = product + inner;
  Real result =
      outer + detail::sum_to_odd(left_over(c, low, inner), left_over(product, inner, outer));
  for (int i = 0; i < width; ++i) {
    if (detail::is_far_from_limits(lane(a, i), lane(b, i), lane(c, i))) continue;
    set_lane(result, i, detail::near_limits(lane(a, i), lane(b, i), lane(c, i)));
  }
  return result;
}

}  // namespace pendcore
