/// \file
/// The slope of a function of one number from central differences, extrapolated as Richardson does.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "arithmetic/epsilon.hpp"

namespace pendcore {

/// The slope of a line from values at h and h/2 to either side of `here`; nothing where they do
/// not lie on one.
inline std::optional<double> slope_of_line(double here, const std::array<double, 2>& ahead,
                                           const std::array<double, 2>& behind, double h) {
  const double rise = ahead[0] - behind[0];
  const double rounding = 4.0 * epsilon * (std::abs(ahead[0]) + std::abs(behind[0]));
  const double bend = (ahead[0] - here) - (here - behind[0]);
  const double twist = rise - 2.0 * (ahead[1] - behind[1]);
  if (std::abs(bend) <= rounding && std::abs(twist) <= rounding) return rise / (2.0 * h);
  return std::nullopt;
}

/// Values at h, h/2, h/4 and h/8.
inline constexpr int steps_of_slope = 4;

/// The slope from `here` and the values to either side. Nothing where a corner lies among the
/// values, or at the value itself: one-sided slopes then differ by as much at half the step, and
/// central differences do not settle. `size` is that of the numbers from which the function is
/// rounded.
inline std::optional<double> extrapolated_slope(double here,
                                                const std::array<double, steps_of_slope>& ahead,
                                                const std::array<double, steps_of_slope>& behind,
                                                double h, double size) {
  std::array<double, steps_of_slope> slope, gap;
  for (int k = 0; k < steps_of_slope; ++k, h *= 0.5) {
    slope[k] = (ahead[k] - behind[k]) / (2.0 * h);
    gap[k] = std::abs((ahead[k] - here) - (here - behind[k])) / h;
  }
  const double rounding = 64.0 * epsilon * std::max(std::abs(here), size) / h;
  double weight = 4.0;
  double without_largest_step = 0.0;
  for (int level = 1; level < steps_of_slope; ++level, weight *= 4.0) {
    without_largest_step = slope.back();
    for (int k = steps_of_slope - 1; k >= level; --k) {
      slope[k] += (slope[k] - slope[k - 1]) / (weight - 1.0);
    }
  }
  // For a smooth function that changes by as much as itself, these differ by 2^-36 of it.
  const double difference = std::abs(slope.back() - without_largest_step);
  const bool settles = difference <= 0x1p-33 * std::abs(slope.back()) + rounding;
  const bool is_smooth = gap[3] <= 0.7 * gap[2] + rounding;
  if (!settles || !is_smooth) return std::nullopt;
  return slope.back();
}

/// The same of a function f(h) of the distance from there, at h or at smaller steps.
template <class Function>
std::optional<double> extrapolated_slope(double here, const Function& f, double h, double size) {
  for (int attempt = 0; attempt < 3; ++attempt, h *= 0x1p-4) {
    std::array<double, steps_of_slope> ahead, behind;
    for (int k = 0; k < steps_of_slope; ++k) {
      ahead[k] = f(std::ldexp(h, -k));
      behind[k] = f(-std::ldexp(h, -k));
    }
    if (const auto slope = extrapolated_slope(here, ahead, behind, h, size)) return slope;
  }
  return std::nullopt;
}

}  // namespace pendcore
