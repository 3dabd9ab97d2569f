#include "pendcore/dynamics/joint_support.hpp"

#include <algorithm>
#include <cmath>

namespace pendcore {
namespace {

/// The size of the torques that an effect can exert on a joint that it acts on, N m.
double torque_scale(const Effect& effect) {
  return std::visit(
      [](const auto& one) {
        double scale = 0.0;
        if constexpr (requires { one.couple(0); }) {
          if (const auto couple = one.couple(0)) {
            scale = std::abs(couple->held) + std::abs(couple->on_phi) + std::abs(couple->gain);
          }
        }
        return std::isfinite(scale) ? scale : 0.0;
      },
      effect);
}

}  // namespace

std::vector<double> natural_speeds(const Scene& scene, const Inertia& inertia) {
  const std::size_t n = scene.links.size();
  std::vector<double> torque(n);
  for (std::size_t j = 0; j < n; ++j) torque[j] = inertia.first_moment[j] * std::abs(scene.gravity);
  for (const Effect& effect : scene.effects) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.joint; }) torque[one.joint - 1] += torque_scale(effect);
        },
        effect);
  }
  double largest = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    torque[j] = std::sqrt(torque[j] / inertia.diagonal[j]);
    largest = std::max(largest, torque[j]);
  }
  if (largest == 0.0) largest = 1.0;  // nothing drives the joints: 1 rad/s
  for (double& speed : torque) speed = speed > 0.0 ? speed : largest;
  return torque;
}

std::vector<JointSupport> joint_supports(const Scene& scene, const std::vector<double>& natural) {
  std::vector<JointSupport> supports(scene.links.size());
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const Effect& effect = scene.effects[i];
    if (const auto* lock = std::get_if<Lock>(&effect)) supports[lock->joint - 1].is_locked = true;
    if (const auto torque = holding_torque(effect)) {
      std::visit(
          [&](const auto& one) {
            if constexpr (requires { one.joint; }) {
              supports[one.joint - 1].friction += *torque;
              supports[one.joint - 1].friction_effects.push_back(i);
            }
          },
          effect);
    }
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.couple(0); }) {
            JointSupport& joint = supports[one.joint - 1];
            if (const auto couple = one.couple(0)) {
              joint.stiffness += std::abs(couple->on_phi);
              joint.damping += std::abs(couple->on_phid);
              joint.torque += std::abs(couple->held) + std::abs(couple->gain);
            }
          }
        },
        effect);
    if (const auto* stop = std::get_if<JointStop>(&effect)) {
      JointSupport& joint = supports[stop->joint - 1];
      const double capture = stop->capture_speed.value_or(1e-9 * natural[stop->joint - 1]);
      const auto [lower, upper] = stop->range;
      if (lower > joint.lower.angle) joint.lower = {lower, stop->restitution, capture};
      if (upper < joint.upper.angle) joint.upper = {upper, stop->restitution, capture};
    }
  }
  return supports;
}

}  // namespace pendcore
