/// \file
/// The variational equations of a scene: how a small change of a state, of the start or of
/// parameters p goes on.
///
///     d(dq)/dt  = dqd
///     d(dqd)/dt = (d qdd/d q) dq + (d qdd/d qd) dqd + d qdd/d p
///
/// The derivatives of qdd are those of linearize(): exact to rounding, in the laws that the run has
/// at the time.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "dynamics/contact/held_joints.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/inverse_dynamics.hpp"
#include "dynamics/jacobian.hpp"
#include "dynamics/joint_forces.hpp"
#include "pendcore/parameters.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

class VariationalEquations {
 public:
  /// Each name is "q0[i]" or "qd0[i]", i counted from 1, a constant "torque[j]" in a joint or a
  /// constant acceleration of the pivot, "pivot.x" or "pivot.y", from rest at the start of the run,
  /// beside what effects give, or a parameter (parameters.hpp). Throws std::invalid_argument for
  /// another name, and for one that stands twice.
  VariationalEquations(const Scene& scene, const std::vector<std::string>& names);
  VariationalEquations(const VariationalEquations&) = delete;  // the Jacobian refers to the modes
  VariationalEquations& operator=(const VariationalEquations&) = delete;

  /// A name that is a parameter.
  struct Parameter {
    Eigen::Index column;  ///< of its change
    double value;
    std::vector<JointSupport> supports;  ///< the slopes of the angles and restitution of stops
  };

  int links() const { return n_; }
  const Scene& scene() const { return scene_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  /// The numbers of the scene along them, in the laws that are in force.
  const std::vector<Mechanism<AlongParameters>>& mechanisms() const { return mechanisms_; }
  const MechanismAlong& mechanism_along() const { return *along_; }
  /// With the laws that are in force.
  const EquationsOfMotion& equations() const { return equations_; }
  /// How often laws have been taken: not at all, until a run starts.
  int changes_of_laws() const { return changes_of_laws_; }

  /// The change of a state with each name at the start, (2n, k).
  Matrix changes_of_start() const;

  /// Takes the laws that a state calls for, of a scene whose laws stay.
  void choose_laws(double t, const double* y);
  /// Takes the laws of a run: its modes, and the joints that it holds.
  void take_laws(double t, const EquationsOfMotion& run, bool forward);

  /// What the equations are at a state y: by_q and by_qd, (n, n), and by each of the parameters,
  /// (n, parameters).
  void at(double t, const double* y, const Eigen::Ref<Matrix>& by_q,
          const Eigen::Ref<Matrix>& by_qd, const Eigen::Ref<Matrix>& by_parameters);
  /// The largest entry of d qdd/d p for each parameter, of links at rest at angles far from those
  /// of a state. Where the entries vanish at the state itself, as at an equilibrium, its last bits
  /// leave a rounding of this size times epsilon.
  Vector sizes_elsewhere(double t, const double* y);
  Vector rates(double t, const double* y) const;  ///< (qd, qdd)
  /// How large d qdd/d p may be by rounding alone, in units of epsilon, at the last point.
  double size_of(const Parameter& one) const {
    return size_ / (one.value == 0.0 ? 1.0 : std::abs(one.value));
  }

 private:
  void put_along(double t, bool forward);

  std::vector<std::string> names_, known_names_;
  Scene scene_;
  int n_;
  EquationsOfMotion equations_;
  Jacobian jacobian_;
  std::vector<Parameter> parameters_;
  ParameterChoice choice_;
  std::vector<int> modes_;
  std::unique_ptr<JointForces> forces_;  ///< on the joints that turn
  std::unique_ptr<MechanismAlong> along_;
  std::vector<Mechanism<AlongParameters>> mechanisms_;
  int changes_of_laws_ = 0;
  ChangesOfAccelerations by_parameters_;
  Vector qdd_;
  double size_ = 0.0;  ///< of the terms of qdd, which may cancel, 1/s^2
};

}  // namespace pendcore
