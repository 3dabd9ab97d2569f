#include "pendcore/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "pendcore/arithmetic/floating_point_environment.hpp"
#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/dynamics/ledger.hpp"
#include "pendcore/fast_mode.hpp"
#include "pendcore/integrate/first_step.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/message.hpp"
#include "pendcore/recorder.hpp"
#include "pendcore/switching.hpp"

namespace pendcore {
namespace {

void check_start(const char* name, const std::vector<double>& values, std::size_t n,
                 const char* unit) {
  if (values.size() != n) {
    throw std::invalid_argument(std::string(name) + ": has " + std::to_string(values.size()) +
                                " numbers: must have " + std::to_string(n) + ", one a link");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(values[i])) {
      refuse(std::string(name) + "[" + std::to_string(i) + "]", values[i], unit);
    }
  }
}

/// A run goes on from where it ended, to times that it has not been asked for.
void check_continuation(const Solution& solution, double t_end, const std::vector<double>& t_eval) {
  const double reached = solution.t_reached;
  // A run of no length has no direction yet: it takes that of what follows.
  const bool has_length = solution.t_end != solution.t0;
  const double span = (has_length ? solution.t_end : t_end) - solution.t0;
  auto before = [span](double a, double b) { return span < 0.0 ? b < a : span > 0.0 && a < b; };
  if (!std::isfinite(t_end) || before(t_end, reached)) {
    refuse("t_end", t_end, "finite and at or beyond the end reached, " + text(reached) + " s");
  }
  const std::vector<double>& asked = solution.options.t_eval;
  if (!asked.empty() && before(t_end, asked.back())) {
    refuse("t_end", t_end, "at or beyond the last time asked for, " + text(asked.back()) + " s");
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
           "beyond the last time asked for so far, " + text(asked.back()) + " s");
  }
}

/// "q_2" for component 1 of a chain of two links, "qd_1" for component 2.
std::string component_name(int i, int n) {
  if (i >= 2 * n) return "the ledger";
  return i < n ? "q_" + std::to_string(i + 1) : "qd_" + std::to_string(i - n + 1);
}

/// "its table goes from 0 to 1 s"
template <class Kind>
std::string span_of(const Kind& effect) {
  std::string what = "table";
  if constexpr (requires { effect.spline; }) what = "spline";
  return "its " + what + " goes from " + text(effect.first_time()) + " to " +
         text(effect.last_time()) + " s";
}

/// What is told where a table or spline does not go on at time t, in the run's direction.
std::string table_that_ends(const Scene& scene, double t, bool forward) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    std::string told;
    std::visit(
        [&](const auto& effect) {
          if constexpr (requires { effect.last_time(); }) {
            const double first = effect.first_time();
            const double last = effect.last_time();
            if (forward ? first <= t && t < last : first < t && t <= last) return;
            told = effect_name(scene, i) + span_of(effect) + ", and the run is at t = " + text(t) +
                   " s: make it longer, or simulate less";
          }
        },
        scene.effects[i]);
    if (!told.empty()) return told;
  }
  return {};
}

/// What happened, and for a run that failed where, and whether it was stiff there.
std::string message_of(const Ending& ending, const Scene& scene, const Solution& solution,
                       const std::string& remark, int ended_by) {
  std::string message(text(ending.status).sentence);
  if (ending.status == Status::at_rest) {
    const double since = solution.resumable.t.high;
    return message + " (at t = " + text(since) + " s: " + remark + ")";
  }
  if (ending.status == Status::event) {
    const std::vector<Event>& events = solution.options.events;
    return message + " (at t = " + text(solution.t_reached) +
           " s: " + event_name(events[ended_by], ended_by) + ")";
  }
  if (text(ending.status).success) return message;
  if (ending.chatters) {
    return "no step leads on: the law changes back and forth (at t = " + text(solution.t_reached) +
           " s): dry friction that reverses at once, or two limits that meet";
  }
  const bool forward = !(solution.t_end < solution.t0);
  std::string table = ending.status == Status::non_finite
                          ? table_that_ends(scene, solution.t_reached, forward)
                          : std::string();
  if (!table.empty()) return table;
  message += " (at t = " + text(solution.t_reached) + " s";
  if (ending.bad >= 0) message += ", " + component_name(ending.bad, solution.n);
  return message + ')';
}

void check_stop(const JointStop& stop, const std::string& where, const std::vector<double>& q0,
                bool backward) {
  const auto& [lower, upper] = stop.range;
  const double phi = relative(q0.data(), stop.joint);
  const double rounding = 1e-12 * std::max(1.0, std::abs(phi));
  if (!(phi >= lower - rounding && phi <= upper + rounding)) {
    refuse("q0: angle of joint " + std::to_string(stop.joint), phi,
           text(lower) + " to " + text(upper) + " rad, as " + where + "range has it");
  }
  if (backward && stop.restitution < 1.0) {
    throw std::invalid_argument(
        "t_span: runs backward: " + where +
        "with a restitution below 1 the past is not unique: run it forward");
  }
}

/// What the effects of a scene ask of a start and of an interval.
void check_run(const Scene& scene, const std::vector<double>& q0, const std::vector<double>& qd0,
               double t0, double t_end) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const std::string where = effect_name(scene, i);
    if (t_end < t0 && holding_torque(scene.effects[i])) {
      throw std::invalid_argument("t_span: runs backward: " + where +
                                  "with dry friction the past is not unique: run it forward");
    }
    if (const auto* stop = std::get_if<JointStop>(&scene.effects[i])) {
      check_stop(*stop, where, q0, t_end < t0);
    }
    const auto* lock = std::get_if<Lock>(&scene.effects[i]);
    if (lock == nullptr) continue;
    const std::string joint = std::to_string(lock->joint);
    const double phi = relative(q0.data(), lock->joint);
    if (lock->angle && !(std::abs(phi - *lock->angle) <= 1e-9 * std::max(1.0, std::abs(phi)))) {
      const std::string name = where.substr(0, where.size() - 2);  // without ": "
      refuse(
          "q0: angle of joint " + joint, phi,
          text(*lock->angle) + " rad, as " + name + " says: start there, or leave its angle out");
    }
    const double rate = relative(qd0.data(), lock->joint);
    if (!(std::abs(rate) <= 1e-12 * std::abs(qd0[lock->joint - 1]))) {
      refuse("qd0: rate of joint " + joint, rate, "0 (rad/s): " + where + "it is locked");
    }
  }
}

/// The ledger has no say in the steps: that it overflowed is seen at the end.
void see_whether_ledger_is_finite(const std::vector<double>& y, int n, Ending& ending) {
  const bool is_finite =
      std::all_of(y.begin() + 2 * n, y.end(), [](double x) { return std::isfinite(x); });
  if (is_finite || !text(ending.status).success) return;
  ending.status = Status::non_finite;
  ending.bad = 2 * n;
}

/// Of a solution that goes on: one that has no length yet has no direction either.
enum class Before { nothing, a_start, steps };

/// From the solution's resumable position to t_end.
void run(const Scene& scene, Solution& solution, double t_end, const Limits& limits, Before before,
         const std::vector<long long>& passed_events = {}) {
  const Options& options = solution.options;
  const EquationsOfMotion equations = equations_of_motion(scene);
  const auto stepper =
      make_stepper(scene, equations, options.method, options.ledger, options.compensated);
  std::optional<Switching> switching;
  if (Switching::is_needed(scene)) switching.emplace(scene, equations, solution.accounts);
  const std::size_t n = scene.links.size();
  const std::vector<double> rtol = relative_tolerances(options, n);
  const std::vector<double> atol = absolute_tolerances(options, n);
  stepper->set_tolerances(rtol.data(), atol.data());

  Recorder recorder(solution, *stepper, scene, passed_events);
  if (before != Before::nothing && solution.dense.degree != stepper->interpolant_degree()) {
    throw std::invalid_argument("the dense output of this solution is not that of its method");
  }
  solution.dense.degree = stepper->interpolant_degree();
  Position position = solution.resumable;
  const double t = position.t.high;
  const bool forward = !(t_end < t);
  const bool begins = before != Before::steps;
  const std::vector<double> before_begin = position.y;
  bool jumped = false;
  Ending ending{.status = Status::finished, .cut = false};
  if (!begins) {
    if (switching) switching->restore(position.breaks, t, position.y.data(), forward);
    stepper->start(position.y.data(), position.dydt.data());
    stepper->restore(position.stepper);
  }
  try {  // functions of the user's may throw
    if (begins) {
      jumped = switching && switching->begin(t, position.y.data(), forward);
      stepper->evaluate(t, position.y.data(), position.dydt.data());
      stepper->start(position.y.data(), position.dydt.data());
    }
    if (position.h == 0.0 && t != t_end) {
      const double size = options.step ? *options.step
                          : options.first_step
                              ? std::min(*options.first_step, options.max_step)
                              : first_step(*stepper, t, forward ? 1.0 : -1.0, options.max_step,
                                           rtol.data(), atol.data());
      position.h = forward ? size : -size;
      position.h_is_max_step = options.step || size == options.max_step;
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
    ending = {.status = Status::callback_error, .cut = false, .error = std::current_exception()};
  }
  if (switching) position.breaks = switching->memory();
  if (before == Before::nothing) recorder.start(t, jumped ? before_begin : position.y);
  if (jumped) recorder.state_jumped(t, before_begin.data(), position.y.data());
  position.statistics.nfev = (begins ? 0 : position.statistics.nfev) + stepper->evaluations;
  if (ending.error) {
    solution.resumable = position;
  } else {
    ending = integrate(*stepper, position, solution.resumable, limits, recorder,
                       switching ? &*switching : nullptr);
  }
  if (!ending.cut) recorder.restarts_here();
  see_whether_ledger_is_finite(position.y, solution.n, ending);
  solution.status = ending.status;
  solution.statistics = position.statistics;
  solution.t_reached = position.t.high;
  solution.y_reached = position.y;
  solution.message = message_of(ending, scene, solution, switching ? switching->remark() : "",
                                recorder.ended_by());
  solution.message +=
      remark_on_steps(scene, equations, position, find_method(options.method), solution.t0);
  solution.error = ending.error;
  if (options.store == Store::end) {
    solution.t = {solution.t_reached};
    solution.states = solution.y_reached;
  }
}

Limits limits_of(const Options& options, double t_end) {
  return {.t_end = t_end,
          .max_step = options.max_step,
          .fixed_step = options.step.has_value(),
          .max_steps = options.max_steps,
          .time_limit = options.time_limit,
          .monitor = options.monitor};
}

}  // namespace

std::vector<std::string> run_warnings(const Scene& scene, const std::vector<double>& q0,
                                      const std::vector<double>& /*qd0*/, double t0, double t_end) {
  std::vector<std::string> warnings;
  // Who writes degrees writes multiples of five, and hardly beyond two turns; in radians such
  // numbers are next to none but 0, 5 and 10.
  const bool as_degrees = std::ranges::all_of(
      q0, [](double q) { return std::fmod(q, 5.0) == 0.0 && std::abs(q) <= 720.0; });
  const auto large = std::ranges::find_if(q0, [](double q) { return std::abs(q) >= 15.0; });
  if (as_degrees && large != q0.end()) {
    warnings.push_back("q0[" + std::to_string(large - q0.begin()) + "] = " + text(*large) +
                       " rad: that is " + text(*large * (180.0 / 3.14159265358979323846)) +
                       " degrees: angles are in radians");
  }
  const double first = std::min(t0, t_end);
  const double last = std::max(t0, t_end);
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    std::visit(
        [&](const auto& effect) {
          if constexpr (requires { effect.last_time(); }) {
            if (effect.first_time() <= first && last <= effect.last_time()) return;
            warnings.push_back(effect_name(scene, i) + span_of(effect) + ", the run from " +
                               text(t0) + " to " + text(t_end) +
                               " s: it ends where it leaves that span");
          }
        },
        scene.effects[i]);
  }
  return warnings;
}

Solution simulate(const Scene& scene, const std::vector<double>& q0, const std::vector<double>& qd0,
                  double t0, double t_end, const Options& options) {
  const FloatingPointEnvironment ieee;
  const std::size_t n = scene.links.size();
  check(scene);
  check_start("q0", q0, n, "finite (rad)");
  check_start("qd0", qd0, n, "finite (rad/s)");
  if (!std::isfinite(t0)) refuse("t_span[0]", t0, "finite (s)");
  if (!std::isfinite(t_end)) refuse("t_span[1]", t_end, "finite (s)");
  check(options);
  for (std::size_t i = 0; i < options.events.size(); ++i) {
    const Event& event = options.events[i];
    check_event(event_name(event, i) + ": ", event, static_cast<int>(n));
  }
  check_times(options.t_eval, t0, t_end);

  Solution solution;
  solution.options = options;
  solution.options.method = find_method(options.method).name;
  solution.options.monitor = nullptr;
  solution.t0 = t0;
  solution.t_end = t_end;
  check_run(scene, q0, qd0, t0, t_end);
  solution.n = static_cast<int>(n);
  if (options.ledger) solution.accounts = accounts_of(scene);
  const std::size_t dimension = 2 * n + solution.accounts.size();
  solution.dimension = static_cast<int>(dimension);
  Position& start = solution.resumable;
  start.t = {t0, 0.0};
  start.y = q0;
  start.y.insert(start.y.end(), qd0.begin(), qd0.end());
  start.y.resize(dimension);
  solution.start = start.y;
  start.dydt.resize(dimension);
  run(scene, solution, t_end, limits_of(options, t_end), Before::nothing);
  return solution;
}

Solution resume(const Scene& scene, const Solution& solution, double t_end,
                const std::vector<double>& t_eval, long long max_steps, double time_limit,
                const Monitor& monitor) {
  const FloatingPointEnvironment ieee;
  Solution longer = solution;
  Options& options = longer.options;
  check_continuation(solution, t_end, t_eval);
  options.max_steps = max_steps;
  options.time_limit = time_limit;
  options.t_eval.insert(options.t_eval.end(), t_eval.begin(), t_eval.end());
  check(options);

  longer.t_end = t_end;
  // What has no step yet begins anew.
  const bool has_begun = solution.resumable.h != 0.0;
  if (!has_begun) {
    const auto middle = solution.start.begin() + solution.n;
    check_run(scene, {solution.start.begin(), middle}, {middle, middle + solution.n}, solution.t0,
              t_end);
  }
  std::vector<long long> passed_events(options.events.size());
  for (const FoundEvent& one : longer.found) ++passed_events[one.event];
  longer.found.resize(longer.resumable_found);
  const auto dimension = static_cast<std::size_t>(longer.dimension);
  const auto degree = static_cast<std::size_t>(longer.dense.degree);
  longer.t.resize(longer.resumable_t);
  longer.states.resize(longer.resumable_t * dimension);
  longer.dense.start.resize(longer.resumable_steps);
  longer.dense.start_low.resize(longer.resumable_steps);
  longer.dense.h.resize(longer.resumable_steps);
  longer.dense.coefficients.resize(longer.resumable_steps * (degree + 1) * dimension);
  Limits limits = limits_of(options, t_end);
  limits.monitor = monitor;
  run(scene, longer, t_end, limits, has_begun ? Before::steps : Before::a_start, passed_events);
  return longer;
}

}  // namespace pendcore
