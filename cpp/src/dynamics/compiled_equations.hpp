/// \file
/// What an object of Equations keeps between its calls.
#pragma once

#include <optional>

#include "dynamics/equations_of_motion.hpp"
#include "dynamics/inverse_dynamics.hpp"
#include "dynamics/jacobian.hpp"
#include "dynamics/joint_forces.hpp"
#include "pendcore/equations.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {

struct Equations::Compiled {
  explicit Compiled(const Scene& given) : scene(given), equations(equations_of_motion(given)) {}

  void require_state(const Numbers& q, const Numbers& qd) const {
    require_size("q", q.span(), scene.links.size());
    require_size("qd", qd.span(), scene.links.size());
  }

  /// The joints that no Lock holds, for their responses to torques.
  JointForces& free_joints() {
    if (!responses) responses = JointForces::on_free_joints(scene, locked_joints(scene));
    return *responses;
  }

  /// The torques and forces of a motion, but for users' functions, with the effects in some modes.
  const InverseDynamics<double>& motion(const std::vector<int>& modes, double t, const Numbers& q,
                                        const Numbers& qd, const Numbers& qdd) {
    if (!constants || modes != modes_of_constants) {
      constants = mechanism(scene, modes);
      modes_of_constants = modes;
    }
    of_motion.compute(*constants, t, q, qd, qdd);
    return of_motion;
  }

  Scene scene;
  EquationsOfMotion equations;
  std::optional<Jacobian> derivatives{};
  std::optional<Jacobian> of_inputs{};           ///< for the responses to inputs (linearize.cpp)
  std::optional<Mechanism<double>> constants{};  ///< for motion()
  std::vector<int> modes_of_constants{};
  InverseDynamics<double> of_motion{};
  std::optional<JointForces> joint_forces{};  ///< for the mass matrix
  std::optional<JointForces> responses{};     ///< of free_joints()
  ChangesOfAccelerations by_parameters{};
};

}  // namespace pendcore
