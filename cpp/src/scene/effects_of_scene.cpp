#include "scene/effects_of_scene.hpp"

#include <algorithm>

#include "effects/behaviour.hpp"
#include "pendcore/effects/lock.hpp"

namespace pendcore {

std::string effect_name(const Scene& scene, std::size_t i) {
  const EffectInfo& info = scene.effects[i].info();
  // Whether a function is Python's or compiled, the core does not know: both are the user's.
  const std::string_view kind = info.is_function ? account_name(info.account) : info.kind;
  return "effect " + std::to_string(i + 1) + " (" + std::string(kind) + ")";
}

PivotMotion pivot_motion(const Scene& scene, double t) {
  PivotMotion sum;
  for (const Effect& effect : scene.effects) {
    if (!effect.info().moves_pivot) continue;
    const PivotMotion one = effect->pivot_motion(t);
    for (int axis = 0; axis < 2; ++axis) {
      sum.position[axis] += one.position[axis];
      sum.velocity[axis] += one.velocity[axis];
      sum.acceleration[axis] += one.acceleration[axis];
    }
  }
  return sum;
}

bool has_functions(const Scene& scene) {
  return std::ranges::any_of(scene.effects,
                             [](const Effect& effect) { return effect.info().is_function; });
}

std::vector<bool> locked_joints(const Scene& scene) {
  std::vector<bool> locked(scene.links.size());
  for (const Lock& lock : effects_of<Lock>(scene)) locked[lock.joint - 1] = true;
  return locked;
}

std::optional<std::size_t> without_series(const Scene& scene) {
  const auto found = std::ranges::find_if_not(
      scene.effects, [](const Effect& effect) { return effect->has_series(); });
  if (found == scene.effects.end()) return std::nullopt;
  return static_cast<std::size_t>(found - scene.effects.begin());
}

}  // namespace pendcore
