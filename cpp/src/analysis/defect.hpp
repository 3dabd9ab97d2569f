/// \file
/// How far a run is from an exact motion: the torques that would make it exact.
///
/// The curve is made of the rates of the dense output, qd(t), and of their integral from the first
/// angles on, q(t). With the mass matrix M and the accelerations qdd of the equations of motion,
///
///     r = d(qd)/dt - qdd(t, q, qd)         rad/s^2
///     tau_j = sum over i >= j of (M r)_i   N m
///
/// tau_j is the torque that a motor in joint j would have to add for the curve to obey the
/// equations exactly. In a held joint tau_j is 0, because its support takes any torque.
///
/// The slope of a dense output of order p is of order p, and so is the torque. For a method of a
/// higher order the torque is an upper bound, because other curves through the same steps need
/// less. The result also has the distance between the integral of the rates and the angles of the
/// dense output, rad.
///
/// Source: Enright, A new error-control for initial value solvers, Appl. Math. Comput. 31 (1989)
/// 288-301, which defines the defect. Cost: for each step 4 (degree + 1) right-hand sides, and
/// O(n^2) operations with each.
#pragma once

#include <cstddef>
#include <vector>

#include "pendcore/solution.hpp"

namespace pendcore {

struct Defect {
  std::vector<double> torque;  ///< (n_steps, n) row-major: the largest |tau_j| of each step, N m
  std::vector<double> apart;   ///< (n_steps): the largest distance of the two angles, rad
};

/// The defect of steps first .. end - 1, each on a grid of 4 (degree + 1) times. `q` (n) has the
/// angles of the curve at the start of these steps, and gets the angles at their end; if it is
/// empty, the curve begins there. Throws std::invalid_argument without dense output.
Defect defect(const Scene& scene, const Solution& solution, std::size_t first, std::size_t end,
              std::vector<double>& q);

}  // namespace pendcore
