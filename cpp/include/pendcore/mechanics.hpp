/// \file
/// Where the joints and the mass centres are, how the mass centres accelerate, and the energy.
///
///     u_i = (cos q_i, sin q_i),  n_i = du_i/dq_i = (-sin q_i, cos q_i)
///     P_i = P_{i-1} + L_i u_i              C_i = P_{i-1} + c_i u_i
///     v_{P_i} = v_{P_{i-1}} + L_i qd_i n_i
///     a_{P_i} = a_{P_{i-1}} + L_i (qdd_i n_i - qd_i^2 u_i),  a_{C_i} likewise with c_i
///     T = sum_i (m_i v_{C_i}^2 + I_i qd_i^2)/2 + sum_j J_j phid_j^2/2     V = -g sum_i m_i y_{C_i}
///
/// (the textbook's section 2.1, Kinematics). Angles (rad), rates (rad/s) and accelerations
/// (rad/s^2) are (n); t is in s. A payload is one more body. Velocities include the velocity of a
/// moving pivot, and V includes the energy of springs; V = 0 at the origin. Cost: O(n). Throws
/// std::invalid_argument for a vector of another size.
#pragma once

#include "pendcore/scene.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

/// The pivot, the joints and the tip, (n + 1, 2), m.
Points positions(const Scene& scene, double t, const Numbers& q);

/// The velocities of the pivot, the joints and the tip, (n + 1, 2), m/s.
Points velocities(const Scene& scene, double t, const Numbers& q, const Numbers& qd);

/// C_i, (n, 2), m; of the links, a payload excluded.
Points mass_centers(const Scene& scene, double t, const Numbers& q);

/// a_{C_i}, (n, 2), m/s^2.
Points mass_center_accelerations(const Scene& scene, double t, const Numbers& q, const Numbers& qd,
                                 const Numbers& qdd);

/// T and V, J.
double kinetic_energy(const Scene& scene, double t, const Numbers& q, const Numbers& qd);
double potential_energy(const Scene& scene, double t, const Numbers& q);

}  // namespace pendcore
