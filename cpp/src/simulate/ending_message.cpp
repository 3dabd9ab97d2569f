#include "simulate/ending_message.hpp"

#include <cmath>
#include <cstdio>

#include "pendcore/methods.hpp"
#include "scene/effects_of_scene.hpp"
#include "simulate/fast_mode.hpp"
#include "simulate/initial_state.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// "q_2" for component 1 of a chain of two links, "qd_1" for component 2.
std::string component_name(int i, int n) {
  return i < n ? "q_" + std::to_string(i + 1) : "qd_" + std::to_string(i - n + 1);
}

/// The message if a table or spline ends at time t, in the run's direction.
std::string table_that_ends(const Scene& scene, double t, bool forward) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (!is_outside_table(*scene.effects[i], t, forward)) continue;
    return effect_name(scene, i) + ": " + span_of(*scene.effects[i]) +
           ", and the run is at t = " + text(t) + " s: extend it, or end the run earlier";
  }
  return {};
}

/// Whether a user's law seems to jump: steps across a jump are rejected, or are so short that the
/// rest of the run would take some hundred million.
bool jumps_under_users(const Scene& scene, const IntegratorState& integrator, double t_end) {
  const Statistics& steps = integrator.statistics;
  const double left = std::abs(t_end - integrator.t.high);
  return has_functions(scene) &&
         (steps.rejected > steps.accepted || std::abs(integrator.h) < 1e-8 * left);
}

/// What may be behind steps that became too small, if there are users' laws.
std::string laws_that_may_jump(const Scene& scene) {
  std::string names;
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (!scene.effects[i].info().is_function) continue;
    names += (names.empty() ? "" : ", ") + effect_name(scene, i);
  }
  if (names.empty()) return names;
  return "; or a law jumps here: " + names +
         ": name the times of its jumps, breaks=[...], and smooth what jumps with the state";
}

/// Where numbers stop being finite.
struct NotFinite {
  int component = -1;  ///< the component of (q, qd), or -1
  int effect = -1;     ///< the effect that is not finite by itself, or -1
};

std::vector<double> accelerations_of(const Scene& scene, double t, const std::vector<double>& y) {
  const std::size_t n = scene.links.size();
  std::vector<double> qdd(n);
  accelerations(equations_of_motion(scene), t, y.data(), y.data() + n, qdd.data());
  return qdd;
}

NotFinite not_finite_at(const Scene& scene, double t, const std::vector<double>& y) {
  const int n = static_cast<int>(scene.links.size());
  if (const int bad = bad_component(y); bad >= 0) return {.component = bad};
  const int bad = bad_component(accelerations_of(scene, t, y));
  if (bad < 0) return {};
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    Scene alone = scene;
    alone.effects = {scene.effects[i]};
    if (bad_component(accelerations_of(alone, t, y)) >= 0) {
      return {.component = n + bad, .effect = static_cast<int>(i)};
    }
  }
  return {.component = n + bad};
}

/// Looks ahead along the slope at the end of a run, as far as the run's last attempts reached: each
/// attempt was longer than the next. It does not look beyond t_end.
NotFinite find_what_is_not_finite(const Scene& scene, const IntegratorState& integrator,
                                  double t_end) {
  const std::size_t n = scene.links.size();
  // A number may stop being finite some steps ahead, roughly where the tangent leads.
  for (const double share : {0.0, 1.0, 4.0, 16.0, 64.0, 256.0}) {
    const double h = share * integrator.h;
    if ((integrator.t.high + h - t_end) * h > 0.0) break;
    std::vector<double> y(integrator.y.begin(), integrator.y.begin() + 2 * n);
    if (h != 0.0) {  // a rate that is not finite spoils no state yet
      for (std::size_t i = 0; i < y.size(); ++i) y[i] += h * integrator.dydt[i];
    }
    try {
      const NotFinite found = not_finite_at(scene, integrator.t.high + h, y);
      if (found.component >= 0) return found;
    } catch (...) {  // a user's function threw, which the run did not call here
      return {};
    }
  }
  return {};
}

std::string short_text(double x) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", x);
  return digits;
}

/// The frequency and damping ratio of a mode in words; for an overdamped mode, the rate at which it
/// dies out.
std::string measure_of(const FastMode& mode) {
  if (mode.damping_ratio > 10.0) return "overdamped, " + short_text(mode.fastest) + " 1/s";
  const double ratio = std::abs(mode.damping_ratio) < 1e-6 ? 0.0 : mode.damping_ratio;
  return short_text(mode.frequency) + " rad/s, damping ratio " + short_text(ratio);
}

constexpr long long many_steps = 1000;
constexpr std::size_t many_links = 100;

}  // namespace

std::string ending_message(const Ending& ending, const Scene& scene, const Solution& solution,
                           const IntegratorState& integrator, const std::string& remark,
                           int ended_by) {
  std::string message(text(ending.status).sentence);
  const Statistics& statistics = integrator.statistics;
  const bool wants_another_method = statistics.stiff && statistics.njev == 0;
  // For a stiff run, the remark on stiffness gives the advice: another method, not more steps.
  if (ending.status == Status::max_steps && wants_another_method) message.resize(message.find(':'));
  const auto at = [&] { return " (at t = " + text(solution.t_reached) + " s"; };
  if (ending.status == Status::at_rest) {
    const double since = solution.resumable->t.high;
    return message + " (at t = " + text(since) + " s: " + remark + ")";
  }
  if (ending.status == Status::event) {
    return message + at() + ": " + event_name(solution.options.events[ended_by], ended_by) + ')';
  }
  if (ending.status == Status::max_turns) {
    return event_name(solution.options.events[ended_by], ended_by) +
           ": every_turn = true: the steps of this run went through more than a million turns, "
           "not counting one a step" +
           at() +
           "): leave every_turn out, or keep the steps below a turn by max_step; resume goes on "
           "with another million";
  }
  if (text(ending.status).success) return message;
  if (ending.chatters) {
    return "no step gets further: the law changes back and forth" + at() +
           "), as where dry friction reverses at once or two limits meet: move one of the limits, "
           "or give the joint some damping";
  }
  const bool forward = !(solution.t_end < solution.t0);
  std::string table = ending.status == Status::non_finite
                          ? table_that_ends(scene, solution.t_reached, forward)
                          : std::string();
  if (!table.empty()) return table;
  if (ending.bad >= 2 * solution.n) {
    const Account account = solution.accounts[ending.bad - 2 * solution.n];
    return "the ledger's " + std::string(account_name(account)) +
           " stopped being finite: without ledger=True the motion can go on" + at() + ')';
  }
  message += at();
  const bool is_cut = ending.status == Status::max_steps || ending.status == Status::time_limit;
  if (is_cut && jumps_under_users(scene, integrator, solution.t_end)) {
    message +=
        "; it makes almost no progress: a law of yours may jump, as sign(w) does, which is not "
        "friction that can hold a joint at rest: use DryJointFriction";
    return message + ')';
  }
  if (ending.status == Status::step_too_small) return message + laws_that_may_jump(scene) + ')';
  if (ending.status != Status::non_finite) return message + ')';
  NotFinite found = find_what_is_not_finite(scene, integrator, solution.t_end);
  if (found.component < 0) found.component = ending.bad;
  if (found.component >= 0) message += ", " + component_name(found.component, solution.n);
  if (found.effect >= 0) message += ", by " + effect_name(scene, found.effect);
  if (solution.options.step &&
      find_method(solution.options.method).kind != MethodKind::implicit_one) {
    message += "; where the fixed step is too long, a shorter one helps, or method=\"radau5\"";
  }
  return message + ')';
}

std::string remark_on_steps(const Scene& scene, const EquationsOfMotion& equations,
                            const Solution& solution, const IntegratorState& integrator) {
  std::string remark;
  const MethodInfo& method = find_method(solution.options.method);
  const Statistics& statistics = integrator.statistics;
  const auto since = [&integrator] { return text(integrator.stiff_since) + " s"; };
  if (statistics.stiff && solution.last_method == method.second_of_pair) {
    remark += "; stiff: went on with " + solution.last_method + " from t = " + since();
  } else if (statistics.stiff && method.kind == MethodKind::pair) {
    remark += "; stiff at t = " + since() + ", but " + std::string(method.second_of_pair) +
              " does not pay: accuracy hardly allows it longer steps";
  } else if (statistics.stiff) {
    remark += "; from t = " + since() +
              " on the steps are limited by stability, not by accuracy: the problem is stiff: "
              "method=\"radau5\" takes longer ones, and " +
              (solution.options.step ? "\"dopri5-radau5\"" : "\"auto\"") +
              " changes over by itself";
  }
  if (statistics.njev > 0) {
    for (std::size_t i = 0; i < scene.effects.size(); ++i) {
      if (!scene.effects[i].info().is_function) continue;
      remark += "; derivatives of " + effect_name(scene, i) + " by differences";
    }
  }
  const std::size_t n = scene.links.size();
  const bool asks_users = equations.effects && !equations.effects->users.empty();
  if (statistics.limited_by_tolerance <= many_steps || scene.effects.empty() || n > many_links ||
      asks_users) {
    return remark;
  }
  const double* const y = integrator.y.data();
  const double h =
      std::abs(integrator.t.high - solution.t0) / static_cast<double>(statistics.accepted);
  const auto mode = fast_mode(scene, equations, integrator.t.high, y, y + n);
  // The mode that set the steps turns by about a radian a step, or is at the border of stability.
  if (!mode || !(0.01 < h * mode->fastest && h * mode->fastest < 10.0)) return remark;
  remark += "; a fast mode set " + std::to_string(statistics.limited_by_tolerance) +
            " steps: " + measure_of(*mode) + ", in joint " + std::to_string(mode->joint);
  if (mode->effect) remark += ", from " + effect_name(scene, *mode->effect);
  if (mode->damping_ratio < 0.5) {
    remark += ": as long as it swings, every method has to follow it; damp it, or lock the joint";
  }
  return remark;
}

}  // namespace pendcore
