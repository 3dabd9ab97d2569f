#include "pendcore/simulate.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "arithmetic/floating_point_environment.hpp"
#include "dynamics/energetics/ledger.hpp"
#include "integrate/loop/first_step.hpp"
#include "integrate/loop/integrate.hpp"
#include "integrate/loop/run_limits.hpp"
#include "pendcore/solution.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/continuation.hpp"
#include "simulate/ending_message.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/method_choice.hpp"
#include "simulate/recorder.hpp"
#include "simulate/steppers.hpp"
#include "simulate/switching.hpp"

namespace pendcore {
namespace {

/// What a solution has before a run: nothing, a start without a direction of time, or steps.
enum class Before { nothing, a_start, steps };

/// The laws, the rates and the first step at the beginning of a run. If a user's function throws,
/// or an impact is not finite, nothing of this is kept, and a continued run begins anew.
struct Beginning {
  const Options& options;
  Stepper& stepper;
  Switching* switching;
  Recorder& recorder;
  const std::vector<double>& rtol;
  const std::vector<double>& atol;
  bool depends_on_end = false;  ///< whether the first step depends on the end of the run

  /// Makes the beginning. `integrator` is not valid if the ending is cut.
  Ending make(IntegratorState& integrator, double t_end) {
    recorder.restarts_here();
    Ending ending{.status = Status::finished, .cut = false};
    try {
      ending.bad = try_to(integrator, t_end);
      if (ending.bad >= 0) ending.status = Status::non_finite;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const Stopped& stopped) {
      ending.status = stopped.status;
    } catch (...) {
      ending.status = Status::callback_error;
      ending.error = std::current_exception();
    }
    ending.cut = ending.status != Status::finished;
    return ending;
  }

 private:
  /// Makes the beginning, and returns the component that is not finite, or -1.
  int try_to(IntegratorState& integrator, double t_end) {
    const double t = integrator.t.high;
    const double direction = t_end < t ? -1.0 : 1.0;
    std::vector<double>& y = integrator.y;
    std::vector<double> before;
    bool jumped = false;
    if (switching != nullptr) {
      before = y;
      jumped = switching->begin(t, y.data(), direction > 0.0);
    }
    if (const int bad = bad_component(y); bad >= 0) return bad;
    stepper.evaluate(t, y.data(), integrator.dydt.data());
    stepper.start(y.data(), integrator.dydt.data());
    if (t != t_end) {
      double size = options.step.value_or(
          std::min(options.first_step.value_or(options.max_step), options.max_step));
      if (!options.step && !options.first_step) {
        const FirstStep first =
            first_step(stepper, t, t_end, options.max_step, rtol.data(), atol.data());
        size = first.h;
        depends_on_end = first.is_bounded;
      }
      integrator.h = direction * size;
      integrator.h_is_max_step = options.step || size == options.max_step;
    }
    if (jumped) {
      recorder.state_jumped(t, before.data(), y.data());
    } else {
      recorder.state_settled(t, y.data());
    }
    return -1;
  }
};

/// Runs from where the integrator stands to t_end.
void run(const Scene& scene, Solution& solution, IntegratorState integrator, double t_end,
         Limits limits, Before before, const std::vector<long long>& passed_events = {}) {
  const Options& options = solution.options;
  const EquationsOfMotion equations = equations_of_motion(scene);
  const auto stepper =
      make_stepper(scene, equations, options.method, options.ledger, options.compensated);
  std::optional<Switching> switching;
  if (equations.held_joints) switching.emplace(scene, equations, solution.accounts);
  const std::size_t n = scene.links.size();
  const std::vector<double> rtol = relative_tolerances(options, n);
  const std::vector<double> atol = absolute_tolerances(options, n);
  stepper->set_tolerances(rtol.data(), atol.data());

  Recorder recorder(solution, *stepper, scene, passed_events);
  if (before != Before::nothing && solution.dense.degree != stepper->interpolant_degree()) {
    throw std::invalid_argument("the dense output of this solution is not that of its method");
  }
  solution.dense.degree = stepper->interpolant_degree();
  IntegratorState resumable = integrator;
  if (before == Before::nothing) recorder.start(integrator.t.high, integrator.y);
  Switching* const discontinuities = switching ? &*switching : nullptr;
  std::optional<RunLimits> clock;
  // Deciding which joints are held is not a step, and takes long in a long chain.
  if (switching && stopped_is_caught) {
    clock.emplace(limits, integrator.t.high);
    switching->look_up_in_long_work([&clock, &integrator] {
      const Status status = clock->look(integrator.t.high);
      if (status != Status::finished) throw Stopped{status};
    });
  }
  Ending ending{.status = Status::finished, .cut = false};
  if (before == Before::steps) {
    const double t = integrator.t.high;
    if (switching)
      switching->restore(integrator.discontinuities, t, integrator.y.data(), !(t_end < t));
    stepper->start(integrator.y.data(), integrator.dydt.data());
    stepper->restore(integrator.stepper);
    integrator.statistics.nfev += stepper->evaluations;
  } else {
    Beginning beginning{options, *stepper, discontinuities, recorder, rtol, atol};
    ending = beginning.make(integrator, t_end);
    if (ending.cut) integrator = resumable;  // which is the start
    limits.begins_anew = beginning.depends_on_end;
    integrator.statistics.nfev = stepper->evaluations;
  }
  if (ending.status == Status::finished) {
    if (switching) integrator.discontinuities = switching->saved_state();
    ending = integrate(*stepper, integrator, resumable, limits, recorder, discontinuities);
  } else {
    resumable = integrator;
  }
  if (!ending.cut) recorder.restarts_here();
  solution.status = ending.status;
  solution.statistics = integrator.statistics;
  solution.t_reached = integrator.t.high;
  solution.resumable = std::make_shared<const IntegratorState>(std::move(resumable));
  solution.message = ending_message(ending, scene, solution, integrator,
                                    switching ? switching->remark() : "", recorder.ended_by());
  if (switching) solution.message += switching->remark_on_impacts();
  solution.last_method = stepper->info().name;
  solution.message += remark_on_steps(scene, equations, solution, integrator);
  solution.error = ending.error;
  solution.options.watch = nullptr;
  solution.y_reached = std::move(integrator.y);
  if (options.store == Store::end) {
    solution.t = {solution.t_reached};
    solution.states = solution.y_reached;
  }
}

long long attempts(const Statistics& statistics) {
  return statistics.accepted + statistics.rejected;
}

Limits limits_of(const Options& options, double t_end) {
  return {.t_end = t_end,
          .max_step = options.max_step,
          .fixed_step = options.step.has_value(),
          .max_steps = options.max_steps,
          .time_limit = options.time_limit.value_or(std::numeric_limits<double>::infinity()),
          .monitor = options.monitor};
}

}  // namespace

Solution simulate(const Scene& scene, const Numbers& q0, const Numbers& qd0, double t0,
                  double t_end, Options options) {
  const FloatingPointEnvironment ieee;
  const std::size_t n = scene.links.size();
  check(scene);
  check_start(scene, q0.span(), qd0.span(), t0, t_end);
  check_options(scene, options, t0, t_end);

  options.method = chosen_method(scene, options);
  options.store = options.store.value_or(usual_store(options));
  Limits limits = limits_of(options, t_end);
  Solution solution(std::move(options));
  solution.scene = scene;
  solution.options.monitor = nullptr;
  solution.t0 = t0;
  solution.t_end = t_end;
  solution.n = static_cast<int>(n);
  if (solution.options.ledger) solution.accounts = accounts_of(scene);
  const std::size_t dimension = 2 * n + solution.accounts.size();
  solution.dimension = static_cast<int>(dimension);
  IntegratorState start;
  start.t = {t0, 0.0};
  start.y.resize(dimension);
  std::ranges::copy(qd0.span(), std::ranges::copy(q0.span(), start.y.begin()).out);
  solution.start = start.y;
  start.dydt.resize(dimension);
  run(scene, solution, std::move(start), t_end, std::move(limits), Before::nothing);
  return solution;
}

Solution resume(const Scene& scene, const Solution& solution, double t_end,
                const NumberList& t_eval, long long max_steps, std::optional<double> time_limit,
                const Monitor& monitor) {
  const FloatingPointEnvironment ieee;
  Solution longer = solution;
  Options& options = longer.options;
  check_continuation(scene, solution, t_end, t_eval);
  options.max_steps = max_steps;
  options.time_limit = time_limit;
  options.t_eval.insert(options.t_eval.end(), t_eval.begin(), t_eval.end());
  check(options);

  longer.t_end = t_end;
  // A run without steps begins anew.
  const IntegratorState& from = *solution.resumable;
  const bool has_begun = from.h != 0.0;
  if (!has_begun) {
    const std::span start(solution.start);
    check_start(scene, start.first(solution.n), start.subspan(solution.n, solution.n), solution.t0,
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
  // If the end is the same, the run repeats what it did since the resumable position. That is not
  // counted as steps of the continuation.
  if (t_end == solution.t_end) {
    const long long again = attempts(solution.statistics) - attempts(from.statistics);
    const long long most = std::numeric_limits<long long>::max() - max_steps;
    limits.max_steps += std::clamp(again, 0LL, most);
  }
  run(scene, longer, from, t_end, std::move(limits), has_begun ? Before::steps : Before::a_start,
      passed_events);
  return longer;
}

}  // namespace pendcore
