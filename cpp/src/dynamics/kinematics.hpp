/// \file
/// Where the joints and the mass centres are, and how the mass centres accelerate.
///
///     u_i = (cos q_i, sin q_i),  n_i = du_i/dq_i = (-sin q_i, cos q_i)
///     P_i = P_{i-1} + L_i u_i              C_i = P_{i-1} + c_i u_i
///     a_{P_i} = a_{P_{i-1}} + L_i (qdd_i n_i - qd_i^2 u_i),  a_{C_i} likewise with c_i
///
/// (the textbook's section 2.1, Kinematics). Angles (rad), rates (rad/s) and accelerations
/// (rad/s^2) are (n); points are (n, 2) row-major, x right and y down. Cost: O(n). A span of
/// another size is refused with std::invalid_argument.
#pragma once

#include <span>

#include "pendcore/scene.hpp"

namespace pendcore {

/// The value of joint j, counted from 1: x_j - x_{j-1}, as phi_j = q_j - q_{j-1}.
inline double relative(const double* x, int joint) {
  return joint > 1 ? x[joint - 1] - x[joint - 2] : x[0];
}

/// Turns joint j, counted from 1, to x_j - x_{j-1} = value.
inline void set_relative(double* x, int joint, double value) {
  x[joint - 1] = joint > 1 ? x[joint - 2] + value : value;
}

/// u_i, (n, 2).
void directions(std::span<const double> q, std::span<double> u);

/// The pivot, the joints and the tip, (n + 1, 2), m, at time t (s).
void positions(const Scene& scene, double t, std::span<const double> q, std::span<double> points);

/// C_i, (n, 2), m, at time t (s); of the links, a payload excluded.
void mass_centers(const Scene& scene, double t, std::span<const double> q,
                  std::span<double> points);

/// a_{C_i}, (n, 2), m/s^2, at time t (s).
void mass_center_accelerations(const Scene& scene, double t, std::span<const double> q,
                               std::span<const double> qd, std::span<const double> qdd,
                               std::span<double> accelerations);

}  // namespace pendcore
