#include "dynamics/contact/held_joints.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "scene/effects_of_scene.hpp"
#include "scene/singular.hpp"

namespace pendcore {
namespace {

std::vector<bool> rigid_joints(const Scene& scene) {
  Scene free = scene;
  const auto locks =
      std::erase_if(free.effects, [](const Effect& effect) { return effect.is<Lock>(); });
  if (locks == 0 || singular_somewhere(free).empty()) return {};
  return locked_joints(scene);
}

}  // namespace

HeldJoints::HeldJoints(const Scene& scene)
    : n_(static_cast<int>(scene.links.size())),
      rigid_(rigid_joints(scene)),
      forces_(scene, rigid_),
      captured_(scene.links.size()),
      bounced_(scene.links.size()),
      holds_(scene.links.size()) {
  supports_ = joint_supports(scene, forces_.inertia);
  natural_speed_ = std::ranges::max(supports_, {}, &JointSupport::natural_speed).natural_speed;
  can_hold_ = std::ranges::any_of(scene.effects, [](const Effect& effect) {
    return effect->holding_torque() || effect.is<JointStop>();
  });
  for (std::vector<double>* row : {&held_qdd_, &free_qdd_, &torque_, &size_}) {
    row->assign(scene.links.size(), 0.0);
  }
}

bool HeldJoints::any_held_for_now() const {
  for (int j = 0; j < n_; ++j) {
    if (is_held(j) && !supports_[j].is_locked) return true;
  }
  return false;
}

void HeldJoints::put_friction(EffectsOfRun& effects, int joint, int mode) {
  for (const std::size_t i : supports_[joint].friction_effects) effects.put_mode(i, mode);
}

void HeldJoints::hold(EffectsOfRun& effects, int joint, double angle) {
  holds_[joint] = {.is_held = true, .angle = angle, .least = -never, .most = never};
  put_friction(effects, joint, 0);
  effects.hold(joint, true);
}

void HeldJoints::lock(int joint, double angle, double* q) {
  holds_[joint] = {.is_held = true, .angle = angle, .least = -never, .most = never};
  set_relative(q, joint + 1, angle);
}

void HeldJoints::set_free(EffectsOfRun& effects) {
  for (int j = 0; j < n_; ++j) effects.hold(j, is_rigid(j));
}

void HeldJoints::release(EffectsOfRun& effects, int joint, int direction) {
  holds_[joint] = Hold{};
  effects.hold(joint, false);
  put_friction(effects, joint, direction);
}

/// A joint touches a stop if its angle is within a few roundings of the end of its range, or beyond
/// it.
Side HeldJoints::contact(int joint, const double* q) const {
  const double phi = relative(q, joint + 1);
  const double size = size_of_relative(q, joint + 1);
  auto is_at = [&](double end, double distance) {
    return std::isfinite(end) && distance <= last_bits_share * (size + std::abs(end));
  };
  const double lower = supports_[joint].lower.angle;
  const double upper = supports_[joint].upper.angle;
  if (is_at(lower, phi - lower)) return Side::lower;
  if (is_at(upper, upper - phi)) return Side::upper;
  return Side::none;
}

std::vector<double> HeldJoints::without_rounding(const double* qd) const {
  std::vector<double> rates(qd, qd + n_);
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = supports_[j];
    const bool may_rest = support.is_locked || !support.friction_effects.empty() ||
                          std::isfinite(support.lower.angle) || std::isfinite(support.upper.angle);
    const double size = size_of_relative(qd, j + 1) + natural_speed_;
    if (may_rest && std::abs(relative(qd, j + 1)) <= last_bits_share * size) {
      set_relative(rates.data(), j + 1, 0.0);
    }
  }
  return rates;
}

void HeldJoints::solve() {
  has_failed_ |= !forces_.problem.solve();
  has_failed_ |= !forces_.problem.lambda.allFinite();
}

void HeldJoints::choose(const EquationsOfMotion& equations, double t, const double* q,
                        const double* qd, int held_in_any_case) {
  EffectsOfRun& effects = *equations.effects;
  std::vector<int>& joints = forces_.joints;
  ForcesBetweenBounds& problem = forces_.problem;
  joints.clear();
  bool any = false;
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = supports_[j];
    const double rate = relative(qd, j + 1);
    const bool is_at_rest =
        rate == 0.0 && (!support.friction_effects.empty() || contact(j, q) != Side::none);
    any |= is_at_rest && !support.is_locked;
    if (is_rigid(j)) {
      hold(effects, j, holds_[j].angle);
      continue;
    }
    if (support.is_locked || is_at_rest) joints.push_back(j);
    if (!support.is_locked) holds_[j] = Hold{};
    put_friction(effects, j, is_at_rest || support.is_locked ? 0 : rate < 0.0 ? -1 : 1);
  }
  set_free(effects);
  if (any) {
    accelerations_in_force(equations, t, q, qd, free_qdd_.data());
    forces_.set_mass_matrix(q);
    forces_.set_up();
    for (int r = 0; r < problem.size; ++r) {
      const int j = joints[r];
      const bool is_locked = supports_[j].is_locked;
      const Side side = contact(j, q);
      problem.a(r) = relative(free_qdd_.data(), j + 1);
      problem.lower(r) = is_locked || side == Side::upper ? -never : -supports_[j].friction;
      problem.upper(r) = is_locked || side == Side::lower ? never : supports_[j].friction;
    }
    solve();
  }
  for (int r = 0; r < static_cast<int>(joints.size()); ++r) {
    const int j = joints[r];
    // A joint at a stop is held at exactly the stop's angle: the last bits of its own angle may
    // come from the rounding of larger angles.
    const Side side = contact(j, q);
    const double angle = supports_[j].is_locked ? holds_[j].angle
                         : side != Side::none   ? supports_[j].stop(side).angle
                                                : relative(q, j + 1);
    if (supports_[j].is_locked || problem.at[r] == Bound::between || j == held_in_any_case) {
      hold(effects, j, angle);
    } else {
      put_friction(effects, j, problem.at[r] == Bound::lower ? 1 : -1);
    }
  }
  if (any) set_slack(equations, t, q, qd);
}

/// Sets the torques at which held joints are released. They are a rounding error beyond the range,
/// so that the next evaluation of the same torque does not release a joint.
void HeldJoints::set_slack(const EquationsOfMotion& equations, double t, const double* q,
                           const double* qd) {
  const ForcesBetweenBounds& problem = forces_.problem;
  torques(equations, t, q, qd, torque_.data());
  for (int r = 0; r < problem.size; ++r) {
    const int j = forces_.joints[r];
    if (!is_held(j) || supports_[j].is_locked) continue;
    const double slack = 64.0 * epsilon * (size_[j] + supports_[j].friction);
    holds_[j].least = std::min(problem.lower(r), torque_[j]) - slack;
    holds_[j].most = std::max(problem.upper(r), torque_[j]) + slack;
  }
}

void HeldJoints::torques(const EquationsOfMotion& equations, double t, const double* q,
                         const double* qd, double* torque) {
  EffectsOfRun& effects = *equations.effects;
  accelerations_in_force(equations, t, q, qd, held_qdd_.data());
  set_free(effects);
  accelerations_in_force(equations, t, q, qd, free_qdd_.data());
  for (int j = 0; j < n_; ++j) effects.hold(j, is_held(j));
  forces_.set_mass_matrix(q);
  double sum = 0.0;
  double size = 0.0;  // the laws' terms count for an eighth: they carry few roundings
  for (int j = 0; j < n_; ++j) {
    const JointSupport& joint = supports_[j];
    size += 0.125 * (joint.stiffness * size_of_relative(q, j + 1) +
                     joint.damping * size_of_relative(qd, j + 1) + joint.torque);
  }
  for (int i = n_ - 1; i >= 0; --i) {
    const auto row = forces_.mass.row(i);
    for (int k = 0; k < n_; ++k) {
      sum += row(k) * (held_qdd_[k] - free_qdd_[k]);
      size += std::abs(row(k)) * (std::abs(held_qdd_[k]) + std::abs(free_qdd_[k]));
    }
    torque[i] = sum;
    size_[i] = size;
  }
}

bool HeldJoints::settle(double* q, double* qd) const {
  bool changed = false;
  for (int j = 0; j < n_; ++j) {
    const double rate_before = j > 0 ? qd[j - 1] : 0.0;
    // A joint whose links do not turn is where it was.
    if (!is_held(j) || (rate_before == 0.0 && qd[j] == 0.0)) continue;
    set_relative(q, j + 1, holds_[j].angle);
    set_relative(qd, j + 1, 0.0);
    changed = true;
  }
  return changed;
}

std::vector<SavedHold> HeldJoints::saved_state() const {
  std::vector<SavedHold> saved(holds_.size());
  for (int j = 0; j < n_; ++j) saved[j] = {.hold = holds_[j], .torque_size = size_[j]};
  return saved;
}

void HeldJoints::restore(EffectsOfRun& effects, const std::vector<SavedHold>& saved,
                         bool has_failed) {
  has_failed_ = has_failed;
  for (int j = 0; j < n_; ++j) {
    holds_[j] = saved[j].hold;
    size_[j] = saved[j].torque_size;
    effects.hold(j, is_held(j));
  }
}

}  // namespace pendcore
