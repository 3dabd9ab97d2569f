/// \file
/// The spacing of doubles at 1. An operation rounds by half of it, relative to its result.
#pragma once

#include <limits>

namespace pendcore {

inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

}  // namespace pendcore
