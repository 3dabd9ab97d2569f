/// \file
/// What the effects of a scene are together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "effects/pivot_motion.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// "effect 2 (viscous_joint)".
std::string effect_name(const Scene& scene, std::size_t i);

/// The position and the motion of the pivot: the sum over all driven pivots.
PivotMotion pivot_motion(const Scene& scene, double t);

/// The number of the first effect that has no Taylor series, counted from 0.
std::optional<std::size_t> without_series(const Scene& scene);

/// Whether some effect is a function of the user's.
bool has_functions(const Scene& scene);

std::vector<bool> locked_joints(const Scene& scene);

}  // namespace pendcore
