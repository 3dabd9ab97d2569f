/// \file
/// Hashes of doubles, for comparisons in which every bit counts, and one sign for every NaN.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace pendcore {

/// Replaces each NaN by the one without a sign: processors give a computed NaN different signs.
inline void give_nan_one_sign(std::span<double> numbers) {
  for (double& x : numbers) {
    if (std::isnan(x)) x = std::numeric_limits<double>::quiet_NaN();
  }
}

/// With this number a hash begins. The function is FNV-1a (Fowler, Noll and Vo) on 64 bits.
inline constexpr std::uint64_t hash_of_nothing = 0xcbf29ce484222325U;

/// The hash `h`, continued with every bit of the numbers, the lowest byte of each first.
inline std::uint64_t hash_bits(std::uint64_t h, std::span<const double> numbers) {
  for (const double x : numbers) {
    auto bits = std::bit_cast<std::uint64_t>(x);
    for (int byte = 0; byte < 8; ++byte, bits >>= 8) h = (h ^ (bits & 0xff)) * 0x100000001b3U;
  }
  return h;
}
inline std::uint64_t hash_bits(std::span<const double> numbers) {
  return hash_bits(hash_of_nothing, numbers);
}

}  // namespace pendcore
