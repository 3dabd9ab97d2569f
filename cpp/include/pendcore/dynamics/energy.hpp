/// \file
/// Kinetic and potential energy of the chain, summed link by link:
///
///     T = sum_i (m_i v_{C_i}^2 + I_i qd_i^2) / 2,     V = -g sum_i m_i y_{C_i}
///
/// J; V = 0 at the height of the pivot.
#pragma once

#include "pendcore/dynamics/kinematics.hpp"

namespace pendcore {

double kinetic_energy(const Scene& scene, Values q, Values qd);
double potential_energy(const Scene& scene, Values q);

}  // namespace pendcore
