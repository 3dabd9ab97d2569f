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
    if (!responses) {
      const std::vector<bool> locked = locked_joints(scene);
      responses.emplace(scene, locked);
      for (std::size_t j = 0; j < locked.size(); ++j) {
        if (!locked[j]) responses->joints.push_back(static_cast<int>(j));
      }
    }
    return *responses;
  }

  Scene scene;
  EquationsOfMotion equations;
  std::optional<Jacobian> derivatives{};
  std::shared_ptr<EffectsOfRun> loads = nullptr;  ///< for reactions
  std::optional<JointForces> joint_forces{};      ///< for the mass matrix
  std::optional<JointForces> responses{};         ///< of free_joints()
  InverseDynamics<Dual<double>> inverse_dynamics{};
};

}  // namespace pendcore
