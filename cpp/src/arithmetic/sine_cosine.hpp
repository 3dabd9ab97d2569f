/// \file
/// Sine and cosine of every lane of a pack of angles, with the same bits on every processor.
///
///     x = n pi/2 + r,  |r| <= pi/4:   sin x and cos x are +-sin r or +-cos r, by n modulo 4
///
/// For |x| <= 1e6 the reduction subtracts n times three parts of pi/2 (33, 53 and 53 bits: the
/// first product is exact, the rounding error of the second is kept), so that r carries a tail; sin
/// r and cos r are polynomials of degree 13 and 14. The error is at most 0.85 ulp. Beyond 1e6, and
/// for infinities and NaN, `sine_cosine_exact` reduces with as many bits of 2/pi as are needed.
///
/// Cost: 45 operations a pack. Throws nothing.
///
/// Source: Cody and Waite, Software Manual for the Elementary Functions (1980), chapter 8. The
/// coefficients are minimax fits (Remez) of (sin r - r)/r^3 and (cos r - 1 + r^2/2)/r^4 in r^2,
/// made by tests/reference/minimax.py; relative errors 2^-57.1 in sin r and 2^-62.1 in cos r.
#pragma once

#include <array>
#include <bit>

#include "arithmetic/pack.hpp"

namespace pendcore {

/// Sine and cosine of any double, with exact argument reduction (Payne and Hanek 1983); slower.
/// Infinities and NaN give NaN.
void sine_cosine_exact(double x, double& sine, double& cosine);

/// Sine and cosine of m angles (rad), in packs on the instruction set of this processor, with the
/// same bits as one by one.
void sine_cosine(const double* x, long long m, double* sine, double* cosine);

namespace sine_cosine_detail {

inline constexpr double largest = 1e6;                      // rad; n < 2^20: n half_pi_1 is exact
inline constexpr double half_pi_1 = 0x1.921fb544p+0;        // pi/2: its leading 33 bits,
inline constexpr double half_pi_2 = 0x1.0b4611a626331p-34;  // the next 53,
inline constexpr double half_pi_3 = 0x1.1701b839a2520p-88;  // and the next
inline constexpr double two_over_pi = 0x1.45f306dc9c883p-1;
inline constexpr double to_integer = 0x1.8p52;  // adding it to x rounds x to an integer

inline constexpr std::array sine = {-0x1.555555555554dp-3,  0x1.111111110fb4dp-7,
                                    -0x1.a01a019c3050bp-13, 0x1.71de356f10fb5p-19,
                                    -0x1.ae5e4c07395e1p-26, 0x1.5d875b9d4c190p-33};
inline constexpr std::array cosine = {0x1.5555555555553p-5,  -0x1.6c16c16c16132p-10,
                                      0x1.a01a019e24bc8p-16, -0x1.27e4f903dba05p-22,
                                      0x1.1eea8935afc8fp-29, -0x1.8ff9c523984f2p-37};

/// Replaces the sines and cosines of those angles that are beyond `largest`, or not finite.
void replace_large(const double* x, int count, double* sine_of_x, double* cosine_of_x);

/// A polynomial of degree 5, summed in pairs of terms whose products do not wait for each other.
template <class Real>
PENDCORE_INLINE Real polynomial(const std::array<double, 6>& c, Real z, Real z2) {
  const Real low = fma(broadcast<Real>(c[1]), z, broadcast<Real>(c[0]));
  const Real middle = fma(broadcast<Real>(c[3]), z, broadcast<Real>(c[2]));
  const Real high = fma(broadcast<Real>(c[5]), z, broadcast<Real>(c[4]));
  return fma(fma(high, z2, middle), z2, low);
}

/// sin(r + tail) and cos(r + tail) for |r| <= pi/4.
template <class Real>
PENDCORE_INLINE void reduced(Real r, Real tail, Real& sine_of_r, Real& cosine_of_r) {
  const Real z = r * r;
  const Real z2 = z * z;
  const Real half = 0.5 * z;
  sine_of_r = r + fma(z * r, polynomial(sine, z, z2), fma(-half, tail, tail));
  const Real leading = 1.0 - half;
  const Real left_over = (1.0 - leading) - half;
  cosine_of_r = leading + fma(z2, polynomial(cosine, z, z2), fma(-r, tail, left_over));
}

/// sin and cos of n pi/2 + r from sin r and cos r; n modulo 4 is in the low bits of `quadrant`.
template <class Real, class Integers>
PENDCORE_INLINE void rotate(Integers quadrant, Real s, Real c, Real& sine_of_x, Real& cosine_of_x) {
  const auto odd = (quadrant & 1) == 1;
  const Integers sine_sign = (quadrant & 2) << 62;
  const Integers cosine_sign = ((quadrant + 1) & 2) << 62;
  const Real sine_size = odd ? c : s;
  const Real cosine_size = odd ? s : c;
  sine_of_x = std::bit_cast<Real>(std::bit_cast<Integers>(sine_size) ^ sine_sign);
  cosine_of_x = std::bit_cast<Real>(std::bit_cast<Integers>(cosine_size) ^ cosine_sign);
}

}  // namespace sine_cosine_detail

/// Sine and cosine of x (rad), lane by lane.
template <class Real>
PENDCORE_INLINE void sine_cosine(const Real& x, Real& sine_of_x, Real& cosine_of_x) {
  namespace detail = sine_cosine_detail;
  using Integers = typename Lanes<Real>::Integers;

  const Real shifted =
      fma(x, broadcast<Real>(detail::two_over_pi), broadcast<Real>(detail::to_integer));
  const Real n = shifted - detail::to_integer;

  // r + tail = x - n pi/2. The second difference may cancel either way: TwoSum (Knuth).
  const Real first = fma(-n, broadcast<Real>(detail::half_pi_1), x);
  const Real product = n * detail::half_pi_2;
  const Real product_error = fma(n, broadcast<Real>(detail::half_pi_2), -product);
  const Real r = first - product;
  const Real back = r - first;
  const Real difference_error = (first - (r - back)) - (product + back);
  const Real tail = fma(-n, broadcast<Real>(detail::half_pi_3), difference_error - product_error);

  Real s, c;
  detail::reduced(r, tail, s, c);
  detail::rotate(std::bit_cast<Integers>(shifted), s, c, sine_of_x, cosine_of_x);

  // One comparison is usually enough for all lanes.
  if (sum_by_halves(absolute(x)) <= detail::largest) [[likely]]
    return;
  if constexpr (Lanes<Real>::width >= 4) {  // through memory, which leaves the packs whole
    double numbers[3][Lanes<Real>::width];
    store(numbers[0], x);
    store(numbers[1], sine_of_x);
    store(numbers[2], cosine_of_x);
    detail::replace_large(numbers[0], Lanes<Real>::width, numbers[1], numbers[2]);
    sine_of_x = load<Real>(numbers[1]);
    cosine_of_x = load<Real>(numbers[2]);
    return;
  }
  for (int i = 0; i < Lanes<Real>::width; ++i) {
    if (!(__builtin_fabs(lane(x, i)) <= detail::largest)) {
      double exact_sine, exact_cosine;
      sine_cosine_exact(lane(x, i), exact_sine, exact_cosine);
      set_lane(sine_of_x, i, exact_sine);
      set_lane(cosine_of_x, i, exact_cosine);
    }
  }
}

}  // namespace pendcore
