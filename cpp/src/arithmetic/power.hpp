/// \file
/// Powers for the step control, with the same bits on every processor.
///
/// A step size needs few digits, but must not depend on a library. So the approximate functions are
/// minimax polynomials of the mantissa (tests/reference/minimax.py). `Real` is a double, or a pack
/// that holds a number of each of several trajectories. `approximate_log2` and `approximate_exp2`
/// do not use fma: code that is not cloned calls them, and there fma would be a call.
#pragma once

#include <array>
#include <bit>

#include "arithmetic/pack.hpp"

namespace pendcore {

namespace power_detail {

/// x = 2^exponent (1 + u), 1/sqrt 2 <= 1 + u < sqrt 2.
template <class Real>
struct Split {
  Real exponent;
  Real u;
};

inline constexpr double to_integer = 0x1.8p52;  ///< adding it rounds to an integer

template <class Real>
PENDCORE_INLINE Split<Real> split(const Real& x) {
  using Integers = typename Lanes<Real>::Integers;
  constexpr long long sqrt_half = 0x3fe6a09e667f3bcd;
  const auto bits = std::bit_cast<Integers>(x);
  const Integers exponent = (bits - sqrt_half) >> 52;
  const Integers mantissa = bits - (exponent << 52);
  const Real u = std::bit_cast<Real>(mantissa) - 1.0;
  if constexpr (Lanes<Real>::width == 1) {
    return {static_cast<double>(exponent), u};
  } else {  // few processors convert packs of such integers
    constexpr auto offset = std::bit_cast<long long>(to_integer);
    return {std::bit_cast<Real>(exponent + offset) - to_integer, u};
  }
}

/// log2(1 + u) = u p(u)
inline constexpr std::array log2_of_mantissa = {
    0x1.71547656bc463p+0, -0x1.71547650c1062p-1, 0x1.ec707e7253c52p-2, -0x1.7154668fe1efdp-2,
    0x1.2780908101543p-2, -0x1.ec86699f3c9b2p-3, 0x1.a3f4af271dcc9p-3, -0x1.6db76d7b0fdd4p-3,
    0x1.5f8fc100f16f2p-3, -0x1.5d960f5e80bc0p-3, 0x1.987b15238e820p-4};

/// 2^f for |f| <= 1/2
inline constexpr std::array exp2_of_fraction = {
    0x1.ffffffffabbccp-1, 0x1.62e42ff11627ap-1,  0x1.ebfbe0a4be886p-3,  0x1.c6b08aaf3156ep-5,
    0x1.3b29dc40d2ec5p-7, 0x1.5d8a7085cddb8p-10, 0x1.446a1fdd54f3ap-13, 0x1.fe1786b50da52p-17};

}  // namespace power_detail

/// log2(x) for x >= 0, within 1e-9; zero and denormal numbers count as 2^-1023, infinity as 2^1024.
template <class Real>
PENDCORE_INLINE Real approximate_log2(const Real& x) {
  const auto& c = power_detail::log2_of_mantissa;
  const auto [exponent, u] = power_detail::split(x);
  Real p = broadcast<Real>(c.back());
  // Written out, as a loop's own instructions would keep the processor from what comes after it.
#pragma GCC unroll 16
  for (int i = c.size() - 2; i >= 0; --i) p = c[i] + p * u;
  return exponent + p * u;
}

/// 2^x within a relative 1e-10, for |x| <= 1000.
template <class Real>
PENDCORE_INLINE Real approximate_exp2(const Real& x) {
  using Integers = typename Lanes<Real>::Integers;
  using power_detail::to_integer;
  const auto& c = power_detail::exp2_of_fraction;
  const Real shifted = x + to_integer;
  const Real f = x - (shifted - to_integer);
  const Real f2 = f * f;
  const Real low = (c[0] + c[1] * f) + (c[2] + c[3] * f) * f2;
  const Real high = (c[4] + c[5] * f) + (c[6] + c[7] * f) * f2;
  const Integers exponent = std::bit_cast<Integers>(shifted) << 52;
  const Real of_fraction = low + high * (f2 * f2);
  return std::bit_cast<Real>(std::bit_cast<Integers>(of_fraction) + exponent);
}

/// log2(x) within 0.05, for x > 0 that is neither denormal nor infinite. The mantissa's logarithm
/// is approximated by a straight line.
template <class Real>
PENDCORE_INLINE Real coarse_log2(const Real& x) {
  constexpr double middle = 1023.0 - 0.043;
  const auto bits = std::bit_cast<typename Lanes<Real>::Integers>(x);
  Real number = x;
  if constexpr (Lanes<Real>::width == 1) {
    number = static_cast<double>(bits);
  } else {
    for (int i = 0; i < Lanes<Real>::width; ++i) number[i] = static_cast<double>(bits[i]);
  }
  return number * 0x1p-52 - middle;
}

/// 2^x within 1 %, for |x| <= 1000.
template <class Real>
PENDCORE_INLINE Real coarse_exp2(const Real& x) {
  using Integers = typename Lanes<Real>::Integers;
  using power_detail::to_integer;
  const Real shifted = x + to_integer;
  const Real f = x - (shifted - to_integer);
  const Real line = fma(broadcast<Real>(0.2426), f, broadcast<Real>(0.6951));
  const Real of_fraction = fma(line, f, broadcast<Real>(1.0));
  const Integers exponent = std::bit_cast<Integers>(shifted) << 52;
  return std::bit_cast<Real>(std::bit_cast<Integers>(of_fraction) + exponent);
}

/// 1/x, exactly, for x = 2^k, |k| < 1023: the bits of x and of 1/x add up to twice those of 1.
template <class Real>
PENDCORE_INLINE Real inverse_of_power_of_two(const Real& x) {
  using Integers = typename Lanes<Real>::Integers;
  constexpr long long sum_of_bits = 2 * std::bit_cast<long long>(1.0);
  return std::bit_cast<Real>(sum_of_bits - std::bit_cast<Integers>(x));
}

/// 2^gain x^power within a relative 1e-9, for |power| <= 0.25. The next step waits for it, so its
/// chain of operations is short. The exponent of x goes through exp2 while the small power of the
/// mantissa, 2^w with w = power log2(1 + u), is summed.
template <class Real>
PENDCORE_INLINE Real scaled_power(const Real& x, double power, const Real& gain) {
  using power_detail::log2_of_mantissa;
  const auto [exponent, u] = power_detail::split(x);
  const auto line = [&u = u](int i) __attribute__((always_inline)) {
    return fma(broadcast<Real>(log2_of_mantissa[i + 1]), u, broadcast<Real>(log2_of_mantissa[i]));
  };
  const Real of_exponent = approximate_exp2(fma(broadcast<Real>(power), exponent, gain));
  const Real u2 = u * u;
  const Real u4 = u2 * u2;
  const Real low = fma(line(2), u2, line(0));
  const Real middle = fma(line(6), u2, line(4));
  const Real high = fma(broadcast<Real>(log2_of_mantissa[10]), u2, line(8));
  const Real w = fma(fma(high, u4, middle), u4, low) * (power * u);
  constexpr std::array e = {0x1.62e42fefa39efp-1, 0x1.ebfbdff82c58fp-3, 0x1.c6b08d704a0c0p-5,
                            0x1.3b2ab6fba4e77p-7, 0x1.5d87fe78a6731p-10};  // ln(2)^k / k!
  const auto line_of_w = [&](double slope, double value) __attribute__((always_inline)) {
    return fma(broadcast<Real>(slope), w, broadcast<Real>(value));
  };
  const Real w2 = w * w;
  const Real of_mantissa =
      fma(fma(line_of_w(e[4], e[3]), w2, line_of_w(e[2], e[1])), w2, line_of_w(e[0], 1.0));
  return of_mantissa * of_exponent;
}

}  // namespace pendcore
