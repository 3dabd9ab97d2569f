/// \file
/// Where the joints and the mass centres are, and how the mass centres accelerate.
///
///     u_i = (cos q_i, sin q_i),  n_i = du_i/dq_i = (-sin q_i, cos q_i)
///     P_i = P_{i-1} + L_i u_i              C_i = P_{i-1} + c_i u_i
///     a_{P_i} = a_{P_{i-1}} + L_i (qdd_i n_i - qd_i^2 u_i),  a_{C_i} likewise with c_i
///
/// (the textbook's section 2.1, Kinematics). Arrays are (n, 2), x right and y down; O(n).
#pragma once

#include <Eigen/Core>

#include "pendcore/scene.hpp"

namespace pendcore {

using Values = Eigen::Ref<const Eigen::VectorXd>;                          ///< (n)
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;  ///< (n, 2)
using PointsOut = Eigen::Ref<Points>;

/// u_i, (n, 2).
Points directions(Values q);

/// The pivot, the joints and the tip, (n + 1, 2), m.
void positions(const Scene& scene, Values q, PointsOut points);

/// C_i, (n, 2), m.
void mass_centers(const Scene& scene, Values q, PointsOut points);

/// a_{C_i}, (n, 2), m/s^2, from angles (rad), rates (rad/s) and accelerations (rad/s^2).
void mass_center_accelerations(const Scene& scene, Values q, Values qd, Values qdd,
                               PointsOut accelerations);

}  // namespace pendcore
