/// \file
/// Angles that seem to be in degrees. Those are usually multiples of five, and hardly more than two
/// turns; in radians such numbers are rare, except for 0, 5 and 10.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "text/message.hpp"

namespace pendcore {

/// Whether an angle (rad) may be one in degrees; 0, 5 and 10 may also be radians.
inline bool may_be_degrees(double x) { return std::fmod(x, 5.0) == 0.0 && std::abs(x) <= 720.0; }

/// Whether it hardly is one in radians.
inline bool is_large_angle(double x) { return std::abs(x) >= 15.0; }

/// The place of the first angle that hardly is one in radians, if all may be in degrees.
inline std::optional<std::size_t> first_in_degrees(std::span<const double> angles) {
  const auto large = std::ranges::find_if(angles, is_large_angle);
  if (large == angles.end() || !std::ranges::all_of(angles, may_be_degrees)) return std::nullopt;
  return static_cast<std::size_t>(large - angles.begin());
}

inline std::string warning_of_degrees(const std::string& name, double x) {
  constexpr double degree = 3.14159265358979323846 / 180.0;
  return name + " = " + text(x) + " rad: that is " + std::to_string(std::lround(x / degree)) +
         " degrees: angles are in radians (numpy.radians converts degrees)";
}

}  // namespace pendcore
