#include "simulate/joint_guards.hpp"

#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "dynamics/kinematics.hpp"

namespace pendcore {
namespace {

using Kind = JointGuard::Kind;

void add_guards_of_laws(const EffectsOfRun& effects, const HeldJoints& joints,
                        std::vector<JointGuard>& guards) {
  for (std::size_t i = 0; i < effects.effects.size(); ++i) {
    const EffectBehaviour& effect = *effects.effects[i];
    const int joint = effect.joint() - 1;
    if (joint < 0 || !effect.has_modes() || effects.held[joint] != 0) continue;
    const bool has_friction = !joints.supports()[joint].friction_effects.empty();
    const std::vector<Guard> of_mode = effect.guards(effects.modes[i]);
    for (std::size_t k = 0; k < of_mode.size(); ++k) {
      const Kind kind = !of_mode[k].is_on_rate() ? Kind::law
                        : has_friction           ? Kind::friction
                                                 : Kind::side;
      guards.push_back({kind, joint, of_mode[k], i, k});
    }
  }
}

void add_guards_of_stops(const EffectsOfRun& effects, const HeldJoints& joints,
                         std::vector<JointGuard>& guards) {
  for (int j = 0; j < static_cast<int>(effects.held.size()); ++j) {
    const JointSupport& support = joints.supports()[j];
    if (effects.held[j] != 0) continue;
    if (support.lower.angle > -never) {
      guards.push_back({Kind::lower_stop, j, {.offset = -support.lower.angle, .on_phi = 1.0}});
    }
    if (support.upper.angle < never) {
      guards.push_back({Kind::upper_stop, j, {.offset = support.upper.angle, .on_phi = -1.0}});
    }
  }
}

/// How many of a guard's value, slope and curvature are zero where the next step starts. A joint
/// that was held until now has neither a rate nor an acceleration yet.
int multiplicity_at_start(const JointGuard& guard, const HeldJoints& joints,
                          const ChangesAtOnce& changes, const double* y, int n) {
  const int j = guard.joint;
  const bool is_still = relative(y + n, j + 1) == 0.0;
  const bool was_held = changes.release_direction[j] != 0 || changes.may_be_rounding();
  if (guard.is_on_rate()) return !is_still ? 0 : was_held ? 2 : 1;
  if (guard.stop() == Side::none || joints.contact(j, y) != guard.stop()) return 0;
  return is_still && was_held ? 3 : 1;
}

}  // namespace

std::vector<JointGuard> joint_guards(const EquationsOfMotion& equations,
                                     const ChangesAtOnce& changes, const double* y) {
  const EffectsOfRun& effects = *equations.effects;
  const HeldJoints& joints = *equations.held_joints;
  const int n = static_cast<int>(effects.held.size());
  std::vector<JointGuard> guards;
  add_guards_of_laws(effects, joints, guards);
  add_guards_of_stops(effects, joints, guards);
  for (JointGuard& guard : guards) {
    guard.multiplicity = multiplicity_at_start(guard, joints, changes, y, n);
  }
  for (int j = 0; j < n; ++j) {
    if (!joints.is_held(j)) continue;
    if (joints.holds()[j].least > -never) guards.push_back({Kind::least_torque, j});
    if (joints.holds()[j].most < never) guards.push_back({Kind::most_torque, j});
  }
  return guards;
}

double JointGuard::value(const double* y, int n) const {
  return linear.offset + linear.on_phi * relative(y, joint + 1) +
         linear.on_phid * relative(y + n, joint + 1);
}

double JointGuard::rounding(const double* y, int n) const {
  return last_bits_share *
         (std::abs(linear.offset) + std::abs(linear.on_phi) * size_of_relative(y, joint + 1) +
          std::abs(linear.on_phid) * size_of_relative(y + n, joint + 1));
}

void JointGuard::polynomial(const double* rows, int degree, int dimension, int n,
                            double* coefficients) const {
  for (int p = 0; p <= degree; ++p, rows += dimension) {
    coefficients[p] =
        linear.on_phi * relative(rows, joint + 1) + linear.on_phid * relative(rows + n, joint + 1);
  }
  coefficients[0] += linear.offset;
}

}  // namespace pendcore
