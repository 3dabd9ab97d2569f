#include "dynamics/possible_state.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/kinematics.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// "q0: angle of joint 2"
std::string of_joint(const NamedNumbers& numbers, const char* what, int joint) {
  return std::string(numbers.name) + ": " + what + " of joint " + std::to_string(joint);
}

}  // namespace

void require_possible(const Scene& scene, const NamedNumbers& q, const NamedNumbers& qd) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (const auto* stop = scene.effects[i].get_if<JointStop>()) {
      const auto [lower, upper] = stop->range;
      const double phi = relative(q.numbers.data(), stop->joint);
      const double rounding = 1e-12 * std::max(1.0, std::abs(phi));
      if (phi >= lower - rounding && phi <= upper + rounding) continue;
      refuse(of_joint(q, "angle", stop->joint), phi,
             text(lower) + " to " + text(upper) + " rad, the range of " + effect_name(scene, i));
    }
    const auto* lock = scene.effects[i].get_if<Lock>();
    if (lock == nullptr) continue;
    const double phi = relative(q.numbers.data(), lock->joint);
    if (lock->angle && !(std::abs(phi - *lock->angle) <= 1e-9 * std::max(1.0, std::abs(phi)))) {
      refuse(of_joint(q, "angle", lock->joint), phi,
             text(*lock->angle) + " rad, as " + effect_name(scene, i) +
                 " says: start there, or leave its angle out");
    }
    const double rate = relative(qd.numbers.data(), lock->joint);
    if (!(std::abs(rate) <= 1e-12 * std::abs(qd.numbers[lock->joint - 1]))) {
      refuse(of_joint(qd, "rate", lock->joint), rate,
             "0 (rad/s), because " + effect_name(scene, i) + " locks it");
    }
  }
}

}  // namespace pendcore
