/// \file
/// Kinetic and potential energy of the chain at time t (s), summed link by link:
///
///     T = sum_i (m_i v_{C_i}^2 + I_i qd_i^2)/2 + sum_j J_j phid_j^2/2     V = -g sum_i m_i y_{C_i}
///
/// A payload is one more body. Velocities include the velocity of a moving pivot, and V includes
/// the energy of springs. T and V are in J, V = 0 at the origin. Angles (rad) and rates (rad/s) are
/// (n). Cost: O(n). A span of another size is refused with std::invalid_argument.
#pragma once

#include "pendcore/dynamics/kinematics.hpp"

namespace pendcore {

double kinetic_energy(const Scene& scene, double t, std::span<const double> q,
                      std::span<const double> qd);
double potential_energy(const Scene& scene, double t, std::span<const double> q);

}  // namespace pendcore
