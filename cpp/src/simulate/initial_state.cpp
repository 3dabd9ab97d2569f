#include "simulate/initial_state.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dynamics/kinematics.hpp"
#include "dynamics/possible_state.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/parameters.hpp"
#include "scene/degrees.hpp"
#include "scene/effects_of_scene.hpp"
#include "scene/singular.hpp"
#include "simulate/checked_options.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

void check_numbers(const char* name, std::span<const double> values, std::size_t n,
                   const char* unit) {
  const bool whole_state = values.size() == 2 * n;
  require_size(
      name, values, n,
      whole_state ? ", one for each link; angles are q0, rates qd0" : ", one for each link");
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(values[i])) {
      refuse(std::string(name) + "[" + std::to_string(i) + "]", values[i], unit);
    }
  }
}

/// Checks what the effects of a scene require of a start and of an interval.
void check_effects_at_start(const Scene& scene, std::span<const double> q0,
                            std::span<const double> qd0, double t0, double t_end) {
  require_possible(scene, {"q0", q0}, {"qd0", qd0});
  if (!(t_end < t0)) return;
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const std::string backward = "the run goes backward: " + effect_name(scene, i) + ": with ";
    if (scene.effects[i]->holding_torque()) {
      throw std::invalid_argument(backward + "dry friction the past is not unique: run it forward");
    }
    const auto* stop = scene.effects[i].get_if<JointStop>();
    if (stop == nullptr || stop->restitution >= 1.0) continue;
    throw std::invalid_argument(backward +
                                "a restitution below 1 the past is not unique: run it forward");
  }
}

/// Looks again at locks that take the angle of the start.
void check_locks_of_start(const Scene& scene, std::span<const double> q0) {
  const auto takes_start = [](const Lock& lock) { return !lock.angle; };
  if (std::ranges::none_of(effects_of<Lock>(scene), takes_start)) return;
  Scene locked = scene;
  for (Effect& effect : locked.effects) {
    const Lock* const lock = effect.get_if<Lock>();
    if (lock == nullptr || lock->angle) continue;
    effect = Lock{.joint = lock->joint, .angle = relative(q0.data(), lock->joint)};
  }
  const std::string reason = singular_somewhere(locked);
  if (!reason.empty()) throw std::invalid_argument("q0: with joints locked as it says: " + reason);
}

/// Checks that every number of the scene is as it was, where that is known.
void check_unchanged(const Scene& scene, const Scene& before) {
  if (before.links.empty()) return;
  const std::vector<NamedNumber> now = parameters(scene);
  const std::vector<NamedNumber> known = parameters(before);
  const auto [one, other] =
      std::ranges::mismatch(now, known, [](const NamedNumber& a, const NamedNumber& b) {
        return a.name == b.name && a.value == b.value;
      });
  if (one == now.end() && other == known.end()) return;
  const std::string rule = ": must be the scene of the solution";
  if (one == now.end() || other == known.end() || one->name != other->name) {
    throw std::invalid_argument("scene: has other effects than the solution" + rule);
  }
  throw std::invalid_argument("scene: " + one->name + " = " + text(one->value) +
                              ", and the solution has " + text(other->value) + rule);
}

}  // namespace

void check_start(const Scene& scene, std::span<const double> q0, std::span<const double> qd0,
                 double t0, double t_end) {
  const std::size_t n = scene.links.size();
  check_numbers("q0", q0, n, "finite (rad)");
  check_numbers("qd0", qd0, n, "finite (rad/s)");
  if (!std::isfinite(t0)) refuse("start of the run", t0, "finite (s)");
  if (!std::isfinite(t_end)) refuse("end of the run", t_end, "finite (s)");
  if (!std::isfinite(t_end - t0)) {
    refuse("end of the run", t_end, "less than 1.8e308 s from its start, " + text(t0) + " s");
  }
  check_effects_at_start(scene, q0, qd0, t0, t_end);
  check_locks_of_start(scene, q0);
}

void check_continuation(const Scene& scene, const Solution& solution, double t_end,
                        const std::vector<double>& t_eval) {
  if (solution.resumable == nullptr) {
    throw std::invalid_argument("solution: is empty: must be what simulate() or resume() returned");
  }
  if (scene.links.size() != static_cast<std::size_t>(solution.n)) {
    throw std::invalid_argument("scene: has " + std::to_string(scene.links.size()) +
                                " links, and the solution has " + std::to_string(solution.n) +
                                ": must be the scene of the solution");
  }
  check_unchanged(scene, solution.scene);
  const double reached = solution.t_reached;
  // A run of no length has no direction yet: it takes the direction of its continuation.
  const bool has_length = solution.t_end != solution.t0;
  const double span = (has_length ? solution.t_end : t_end) - solution.t0;
  auto before = [span](double a, double b) { return span < 0.0 ? b < a : span > 0.0 && a < b; };
  const std::string beyond = span < 0.0 ? "before " : "beyond ";
  const std::string way = span < 0.0 ? " s: this run goes back in time" : " s";
  if (!std::isfinite(t_end) || before(t_end, reached)) {
    refuse("t_end", t_end,
           "finite and at or " + beyond + "the end reached, " + text(reached) + way);
  }
  const std::vector<double>& asked = solution.options.t_eval;
  if (!asked.empty() && before(t_end, asked.back())) {
    refuse("t_end", t_end,
           "at or " + beyond + "the last time asked for, " + text(asked.back()) + way);
  }
  if (t_eval.empty()) return;
  if (asked.empty()) {
    throw std::invalid_argument(
        "t_eval: this run was not asked for times, and keeps what it kept so far: leave t_eval "
        "out");
  }
  check_times(t_eval, reached, t_end);
  if (!before(asked.back(), t_eval.front())) {
    refuse("t_eval[0]", t_eval.front(),
           beyond + "the last time asked for so far, " + text(asked.back()) + way);
  }
}

bool is_outside_table(const EffectBehaviour& effect, double t, bool forward) {
  const double first = effect.first_time();
  const double last = effect.last_time();
  return forward ? t < first || t >= last : t <= first || t > last;
}

std::string span_of(const EffectBehaviour& effect) {
  return std::string("its ") + (effect.info().moves_pivot ? "spline" : "table") + " goes from " +
         text(effect.first_time()) + " to " + text(effect.last_time()) + " s";
}

std::vector<std::string> run_warnings(const Scene& scene, std::span<const double> q0, double t0,
                                      double t_end) {
  std::vector<std::string> warnings;
  if (const auto i = first_in_degrees(q0)) {
    warnings.push_back(warning_of_degrees("q0[" + std::to_string(*i) + "]", q0[*i]));
  }
  const double first = std::min(t0, t_end);
  const double last = std::max(t0, t_end);
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    if (effect.first_time() <= first && last <= effect.last_time()) continue;
    warnings.push_back(effect_name(scene, i) + ": " + span_of(effect) + ", the run from " +
                       text(t0) + " to " + text(t_end) +
                       " s: the run ends where it leaves that span");
  }
  return warnings;
}

}  // namespace pendcore
