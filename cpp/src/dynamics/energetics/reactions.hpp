/// \file
/// The joint reactions from given accelerations, from the tip to the base (equations.hpp).
#pragma once

#include <span>

#include "dynamics/acting_effects.hpp"
#include "dynamics/kinematics.hpp"

namespace pendcore {

/// (n, 2) row-major, N, from angles (rad), rates (rad/s) and accelerations (rad/s^2), (n) each, and
/// the effects of the scene, effects_in_force(scene), which are put in the modes of the state.
/// Cost: O(n). A span of another size is refused with std::invalid_argument.
void reactions(const Scene& scene, EffectsInForce& effects, double t, std::span<const double> q,
               std::span<const double> qd, std::span<const double> qdd, std::span<double> forces);

}  // namespace pendcore
