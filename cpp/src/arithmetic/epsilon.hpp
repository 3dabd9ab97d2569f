/// \file
/// The spacing of doubles at 1. An operation rounds by half of it, relative to its result.
#pragma once

#include <limits>

namespace pendcore {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Numbers that differ by less than this share count as the same: they differ in their last bits.
inline constexpr double last_bits_share = 4.0 * epsilon;

}  // namespace pendcore
