#include "simulate/ending_message.hpp"

#include "integrate/loop/integrate.hpp"
#include "pendcore/methods.hpp"
#include "scene/effects_of_scene.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/not_finite.hpp"
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

/// Whether a user's law seems to jump: every step across a jump is rejected.
bool jumps_under_users(const Scene& scene, const Statistics& statistics) {
  return has_functions(scene) && statistics.rejected > statistics.accepted;
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

}  // namespace

std::string ending_message(const Ending& ending, const Scene& scene, const Solution& solution,
                           const IntegratorState& integrator, const std::string& remark,
                           int ended_by) {
  std::string message(text(ending.status).sentence);
  const Statistics& statistics = integrator.statistics;
  const bool wants_another_method = statistics.stiff && statistics.njev == 0;
  // For a stiff run, the remark on stiffness gives the advice: another method, not more steps.
  if (ending.status == Status::max_steps && wants_another_method) message.resize(message.find(':'));
  if (ending.status == Status::at_rest) {
    const double since = solution.resumable->t.high;
    return message + " (at t = " + text(since) + " s: " + remark + ")";
  }
  if (ending.status == Status::event) {
    const std::vector<Event>& events = solution.options.events;
    return message + " (at t = " + text(solution.t_reached) +
           " s: " + event_name(events[ended_by], ended_by) + ")";
  }
  if (ending.status == Status::max_turns) {
    return event_name(solution.options.events[ended_by], ended_by) +
           ": every_turn = true: the steps of this run went through more than a million turns, "
           "not counting one a step (at t = " +
           text(solution.t_reached) +
           " s): leave every_turn out, or keep the steps below a turn by max_step; resume goes on "
           "with another million";
  }
  if (text(ending.status).success) return message;
  if (ending.chatters) {
    return "no step gets further: the law changes back and forth (at t = " +
           text(solution.t_reached) +
           " s), as where dry friction reverses at once or two limits meet: move one of the "
           "limits, "
           "or give the joint some damping";
  }
  const bool forward = !(solution.t_end < solution.t0);
  std::string table = ending.status == Status::non_finite
                          ? table_that_ends(scene, solution.t_reached, forward)
                          : std::string();
  if (!table.empty()) return table;
  const std::string at = " (at t = " + text(solution.t_reached) + " s";
  if (ending.bad >= 2 * solution.n) {
    const Account account = solution.accounts[ending.bad - 2 * solution.n];
    return "the ledger's " + std::string(account_name(account)) +
           " stopped being finite: without ledger=True the motion can go on" + at + ')';
  }
  message += at;
  if (ending.status == Status::max_steps && jumps_under_users(scene, statistics)) {
    message +=
        "; most steps were rejected: a law of yours that jumps, as sign(w) does, is not "
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

}  // namespace pendcore
