/// \file
/// The derivatives of the angular accelerations by the angles and by the rates,
///
///     by_q[i][j] = d qdd_i / d q_j  (1/s^2)      by_qd[i][j] = d qdd_i / d qd_j  (1/s)
///
/// They are exact to rounding: the right-hand side is evaluated on dual numbers, for each of the 2n
/// directions, in the current modes. A chain takes four or eight of them at a time, and each has
/// the bits that it has alone. A user's function does not take dual numbers: its part is
/// differentiated by central differences, one direction at a time, which are accurate to about ten
/// digits.
///
/// The state's derivative y' = (qd, qdd) has the Jacobian ((0, 1), (by_q, by_qd)). Cost: 2n
/// right-hand sides, each two to three times as expensive, or for eight directions of a chain three
/// times; no allocation. Throws what a user's function throws.
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

  /// Computes qdd (n) at (q, qd), and its derivatives along directions (dq, dqd) of the state,
  /// by_q dq + by_qd dqd: a row of dq, of dqd and of `changes` for each, (count, n).
  void along(double t, const double* q, const double* qd, int count, const double* dq,
             const double* dqd, double* qdd, double* changes) const;

 private:
  /// What computes a direction, or as many as `Number` has slopes.
  template <class Number>
  struct Directions {
    std::shared_ptr<ChainOf<Number>> chain;  ///< if the form is a chain, and takes so many
    std::vector<Number> row;                 ///< q, qd and qdd
  };
  template <class Number>
  void compute(double t, Directions<Number>& some) const;
  template <class Number, class Put, class Take>
  void in_turn(Directions<Number>& some, double t, const double* q, const double* qd, int count,
               const Put& put, const Take& take) const;
  template <class Put, class Take>
  void in_turn(double t, const double* q, const double* qd, int count, const Put& put,
               const Take& take) const;

  int n_;
  bool has_special_kernels_ =
      has_special_kernels_of_rare_runs && instruction_set() >= special_sets.least;
  EquationsOfMotion equations_;
  mutable Directions<Dual<double>> one_;
  mutable Directions<Dual<double, Pack<4>>> four_;
  mutable Directions<Dual<double, Pack<8>>> eight_;
};

}  // namespace pendcore
