/// \file
/// The derivatives of the angular accelerations by the angles and by the rates,
///
///     by_q[i][j] = d qdd_i / d q_j  (1/s^2)      by_qd[i][j] = d qdd_i / d qd_j  (1/s)
///
/// They are exact to rounding: the right-hand side is evaluated on dual numbers, once for each of
/// the 2n directions, in the current modes. A user's function does not take dual numbers: its part
/// is differentiated by central differences, which are accurate to about ten digits.
///
/// The state's derivative y' = (qd, qdd) has the Jacobian ((0, 1), (by_q, by_qd)). Cost: 2n
/// right-hand sides, each two to three times as expensive; no allocation. Throws what a user's
/// function throws.
#pragma once

#include <vector>

#include "dynamics/equations_of_motion.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

class Jacobian {
 public:
  /// The Jacobian shares the modes in force with the equations of its scene.
  Jacobian(const Scene& scene, const EquationsOfMotion& equations);

  /// by_q and by_qd, (n, n), from the time (s), angles (rad) and rates (rad/s), (n) each.
  void operator()(double t, const double* q, const double* qd, Eigen::Ref<Matrix> by_q,
                  Eigen::Ref<Matrix> by_qd) const;

  /// Computes qdd at (q, qd), and its derivative (n) along one direction (dq, dqd) of the state,
  /// by_q dq + by_qd dqd. Cost: two to three right-hand sides.
  void along(double t, const double* q, const double* qd, const double* dq, const double* dqd,
             double* qdd, double* change) const;

 private:
  void compute(double t) const;
  void direction_by_direction(double t, const double* q, const double* qd, Eigen::Ref<Matrix> by_q,
                              Eigen::Ref<Matrix> by_qd) const;

  int n_;
  EquationsOfMotion equations_;
  std::shared_ptr<ChainOf<Dual<double>>> chain_;  ///< on dual numbers, if the form is a chain
  mutable std::vector<Dual<double>> q_, qd_, qdd_;
};

}  // namespace pendcore
