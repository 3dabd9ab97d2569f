/// \file
/// How far a run is from an exact motion: the torques that would make it one.
///
/// The curve is made of the rates of the dense output, qd(t), and of their integral from the first
/// angles on, q(t). With the mass matrix M and the accelerations qdd of the equations of motion,
///
///     r = d(qd)/dt - qdd(t, q, qd)         rad/s^2
///     tau_j = sum over i >= j of (M r)_i   N m
///
/// are what a motor in each joint would have to add for that curve to obey the equations exactly.
/// Where a joint is held, what holds it takes any torque: tau_j is 0 there.
///
/// The slope of a dense output of order p is of order p, and so is the torque: for a method of a
/// higher order an upper bound, as other curves through the same steps need less. Also told is how
/// far the integral of the rates comes from the angles of the dense output, rad.
///
/// Source: Enright, A new error-control for initial value solvers, Appl. Math. Comput. 31 (1989)
/// 288-301, of the defect. Cost: 4 (degree + 1) right-hand sides and O(n^2) each, a step.
#pragma once

#include <cstddef>
#include <vector>

#include "pendcore/simulate/solution.hpp"

namespace pendcore {

struct Defect {
  std::vector<double> torque;  ///< (n_steps, n) row-major: the largest |tau_j| of each step, N m
  std::vector<double> apart;   ///< (n_steps): the largest distance of the two angles, rad
};

/// The defect of steps first .. end - 1, each on a grid of 4 (degree + 1) times. `q` (n) are
/// the curve's angles where they begin, and become those where they end; none: it begins there.
/// Throws std::invalid_argument without dense output.
Defect defect(const Scene& scene, const Solution& solution, std::size_t first, std::size_t end,
              std::vector<double>& q);

}  // namespace pendcore
