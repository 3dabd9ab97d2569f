/// \file
/// How an impact changes small changes of a state: Newton's law (impact_laws.hpp) in the joints A
/// whose stops push, and what it becomes for another state or other parameters. x = qd+ - qd-,
///
///     M x = J_A^T Lambda,     J_A x = -(1 + e) J_A qd-
///     M dx = J_A^T dLambda - dM x,   J_A dx = -(1 + e) J_A dqd - de J_A qd-
#pragma once

#include <string>

#include "analysis/variational_equations.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

/// A sum of terms that is smaller than this share of them is rounding.
inline constexpr double rounding_of_rates = 1e-9;

/// The largest entry, or 0.
inline double largest(const Matrix& numbers) {
  return numbers.size() == 0 ? 0.0 : numbers.cwiseAbs().maxCoeff();
}
/// Makes the changes with one name NaN, and says why, unless they are NaN.
void refuse_name(const std::string& name, double t, const std::string& why, Eigen::Index column,
                 Matrix& changes, std::string& told);
inline std::string joint_name(int joint) { return "joint " + std::to_string(joint + 1); }

class ImpactOnChanges {
 public:
  explicit ImpactOnChanges(const VariationalEquations& equations);

  /// Brings changes (2n, k) of the state before the impact, at its time, to those after it. The
  /// laws before it are in force. Returns why there are none, or nothing; `told` is told why some
  /// names alone have none any more.
  std::string strike(const WatchedChange& change, Matrix& changes, std::string& told);

 private:
  Matrix torques_of_changed_mass(const Numbers& q, const Vector& x, const Matrix& changes);

  const VariationalEquations& equations_;
  int n_;
  Eigen::Index k_;
  JointForces forces_;  ///< on the joints that no lock holds
  InverseDynamics<AlongParameters> of_mass_;
};

}  // namespace pendcore
