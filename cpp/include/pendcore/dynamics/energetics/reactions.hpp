/// \file
/// The joint reactions, from the tip to the base:
///
///     F_{i-1,i} = m_i (a_{C_i} - g e_y) - F_ext,i + F_{i,i+1},    F_{n,n+1} = m_p (a_tip - g e_y)
///
/// the force ON link i FROM link i-1 at joint i, N: row 1 is the textbook's F_01 (from the ground),
/// row 2 is F_12 = -F_21 (Eq. (2.3), y downward: the weight is +m g e_y).
#pragma once

#include "pendcore/dynamics/acting_effects.hpp"
#include "pendcore/dynamics/kinematics.hpp"

namespace pendcore {

/// (n, 2) row-major, N, from angles (rad), rates (rad/s) and accelerations (rad/s^2), (n) each.
/// Cost: O(n). A span of another size is refused with std::invalid_argument.
void reactions(const Scene& scene, double t, std::span<const double> q, std::span<const double> qd,
               std::span<const double> qdd, std::span<double> forces);

/// The same for many states of a scene, whose effects are compiled once, by
/// effects_in_force(scene). They are put in the modes of the state.
void reactions(const Scene& scene, EffectsInForce& effects, double t, std::span<const double> q,
               std::span<const double> qd, std::span<const double> qdd, std::span<double> forces);

}  // namespace pendcore
