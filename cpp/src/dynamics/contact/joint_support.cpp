#include "dynamics/contact/joint_support.hpp"

#include <algorithm>
#include <cmath>

#include "effects/behaviour.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"

namespace pendcore {
namespace {

/// Adds the couple of an effect to the joint that it acts on.
void add_law(const EffectBehaviour& effect, std::vector<JointSupport>& supports) {
  const auto couple = effect.couple(0);
  if (!couple) return;
  const double torque = std::abs(couple->held) + std::abs(couple->gain);
  const double stiffness = std::abs(couple->on_phi);
  const double damping = std::abs(couple->on_phid);
  if (!std::isfinite(torque + stiffness + damping)) return;
  JointSupport& joint = supports[effect.joint() - 1];
  joint.torque += torque;
  joint.stiffness += stiffness;
  joint.damping += damping;
}

void set_natural_speeds(const Scene& scene, const Inertia& inertia,
                        std::vector<JointSupport>& supports) {
  double largest = 0.0;
  for (std::size_t j = 0; j < supports.size(); ++j) {
    JointSupport& joint = supports[j];
    const double weight = inertia.links[j].first_moment * std::abs(scene.gravity);
    const double drive = weight + joint.torque + joint.stiffness;
    if (inertia.links[j].diagonal > 0.0) {  // else a lock turns it with another link
      joint.natural_speed = std::sqrt(drive / inertia.links[j].diagonal);
    }
    largest = std::max(largest, joint.natural_speed);
  }
  if (largest == 0.0) largest = 1.0;  // nothing drives the joints: 1 rad/s
  for (JointSupport& joint : supports) {
    if (joint.natural_speed == 0.0) joint.natural_speed = largest;
  }
}

void add_stop(const JointStop& stop, std::vector<JointSupport>& supports) {
  JointSupport& joint = supports[stop.joint - 1];
  const double capture = stop.capture_speed.value_or(1e-9 * joint.natural_speed);
  const auto [lower, upper] = stop.range;
  if (lower > joint.lower.angle) joint.lower = {lower, stop.restitution, capture};
  if (upper < joint.upper.angle) joint.upper = {upper, stop.restitution, capture};
}

}  // namespace

std::vector<JointSupport> joint_supports(const Scene& scene, const Inertia& inertia) {
  std::vector<JointSupport> supports(scene.links.size());
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    if (scene.effects[i].is<Lock>()) supports[effect.joint() - 1].is_locked = true;
    if (const auto torque = effect.holding_torque()) {
      supports[effect.joint() - 1].friction += *torque;
      supports[effect.joint() - 1].friction_effects.push_back(i);
    }
    add_law(effect, supports);
  }
  set_natural_speeds(scene, inertia, supports);
  for (const JointStop& stop : effects_of<JointStop>(scene)) add_stop(stop, supports);
  return supports;
}

}  // namespace pendcore
