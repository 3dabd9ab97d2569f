/// \file
/// Exponential, logarithm and power for laws of force, with the same bits on every processor.
///
///     exp x = 2^k exp r,  r = x - k ln 2,  |r| <= ln(2)/2:  Taylor's series to r^13
///     log x = k ln 2 + 2 (f + f^3/3 + f^5/5 + ...),  f = (m - 1)/(m + 1),  x = 2^k m
///     x^p   = exp(p log x), and x x for p = 2
///
/// exp and log are within 2e-15 of the true value, relatively. The error of p log x, absolutely, is
/// the relative error of x^p. Cost: 20 operations a lane for exp, 25 for log. Throws nothing.
#pragma once

#include <bit>
#include <cstdint>

#include "arithmetic/pair.hpp"

namespace pendcore {

/// exp x; 0 below -708, infinity above 709.
PENDCORE_INLINE double exponential(double x) {
  if (!(x >= -708.0)) return x < -708.0 ? 0.0 : x;  // NaN stays NaN
  if (x > 709.0) return __builtin_inf();
  constexpr double to_integer = 0x1.8p52;
  constexpr double ln2_high = 0x1.62e42fefa0000p-1;
  constexpr double ln2_low = 0x1.cf79abc9e3b3ap-40;
  const double shifted = fma(x, 0x1.71547652b82fep+0, to_integer);
  const double k = shifted - to_integer;
  const double r = fma(-k, ln2_low, fma(-k, ln2_high, x));
  double sum = 1.0;
  for (int i = 13; i > 0; --i) sum = fma(sum, r * (1.0 / i), 1.0);
  const auto bits = std::bit_cast<std::int64_t>(shifted) << 52;
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(sum) + bits);
}

/// log x for x > 0, minus infinity for 0; denormal numbers count as 0.
PENDCORE_INLINE double logarithm(double x) {
  if (!(x >= 0x1p-1022)) return x >= 0.0 ? -__builtin_inf() : __builtin_nan("");
  if (x == __builtin_inf()) return x;
  constexpr std::uint64_t sqrt_half = 0x3fe6a09e667f3bcd;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::int64_t k = static_cast<std::int64_t>(bits - sqrt_half) >> 52;
  const double m = std::bit_cast<double>(bits - (static_cast<std::uint64_t>(k) << 52));
  const double f = (m - 1.0) / (m + 1.0);
  const double z = f * f;
  double sum = 0.0;
  for (int i = 23; i > 1; i -= 2) sum = fma(sum, z, 1.0 / i);
  const double of_mantissa = 2.0 * fma(f * z, sum, f);
  return fma(static_cast<double>(k), 0x1.62e42fefa39efp-1, of_mantissa);
}

/// Lane by lane.
template <class Real>
  requires(Lanes<Real>::width > 1)
PENDCORE_INLINE Real exponential(const Real& x) {
  Real result;
  for (int i = 0; i < Lanes<Real>::width; ++i) set_lane(result, i, exponential(lane(x, i)));
  return result;
}

/// x^p for x >= 0 and p > 0, lane by lane.
template <class Real>
PENDCORE_INLINE Real power(const Real& x, double p) {
  if (p == 2.0) return x * x;
  if (p == 1.0) return x;
  Real result;
  for (int i = 0; i < Lanes<Real>::width; ++i) {
    set_lane(result, i, exponential(p * logarithm(lane(x, i))));
  }
  return result;
}

template <RowOfNumbers Row>
PENDCORE_INLINE Row exponential(const Row& x) {
  return Row::each([](const auto& a) __attribute__((always_inline)) { return exponential(a); }, x);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row power(const Row& x, double p) {
  return Row::each([p](const auto& a) __attribute__((always_inline)) { return power(a, p); }, x);
}

}  // namespace pendcore
