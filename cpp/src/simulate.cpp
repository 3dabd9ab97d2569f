#include "pendcore/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pendcore/arithmetic/floating_point_environment.hpp"
#include "pendcore/integrate/first_step.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/message.hpp"
#include "pendcore/recorder.hpp"

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
  auto before = [span](double a, double b) { return (b - a) * span > 0.0; };
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
std::string component_name(int i, int dimension) {
  const int n = dimension / 2;
  return i < n ? "q_" + std::to_string(i + 1) : "qd_" + std::to_string(i - n + 1);
}

/// What happened, and for a run that failed where, and whether it was stiff there.
std::string message_of(const Ending& ending, const Solution& solution) {
  std::string message(text(ending.status).sentence);
  if (text(ending.status).success) return message;
  message += " (at t = " + text(solution.t_reached) + " s";
  if (ending.bad >= 0) message += ", " + component_name(ending.bad, solution.dimension);
  message += ')';
  if (solution.statistics.stiff) {
    message += "; the steps are limited by stability, not by accuracy: the problem is stiff";
  }
  return message;
}

/// From the solution's resumable position to t_end.
void run(const Scene& scene, Solution& solution, double t_end, const Limits& limits,
         bool from_the_start) {
  const Options& options = solution.options;
  const auto stepper = make_stepper(scene, options.method);
  const std::size_t n = scene.links.size();
  const std::vector<double> rtol = relative_tolerances(options, n);
  const std::vector<double> atol = absolute_tolerances(options, n);
  stepper->set_tolerances(rtol.data(), atol.data());

  Recorder recorder(solution, *stepper);
  if (!from_the_start && solution.dense.degree != stepper->interpolant_degree()) {
    throw std::invalid_argument("the dense output of this solution is not that of its method");
  }
  solution.dense.degree = stepper->interpolant_degree();
  Position position = solution.resumable;
  const double t = position.t.high;
  if (from_the_start) {
    stepper->evaluate(t, position.y.data(), position.dydt.data());
    recorder.start(t, position.y);
  }
  stepper->start(position.y.data(), position.dydt.data());
  if (position.h == 0.0 && t != t_end) {
    const double direction = t_end < t ? -1.0 : 1.0;
    const double size = options.step         ? *options.step
                        : options.first_step ? std::min(*options.first_step, options.max_step)
                                             : first_step(*stepper, t, direction, options.max_step,
                                                          rtol.data(), atol.data());
    position.h = direction * size;
    position.h_is_max_step = options.step || size == options.max_step;
  }
  position.statistics.nfev += stepper->evaluations;
  const Ending ending = integrate(*stepper, position, solution.resumable, limits, recorder);
  if (!ending.cut) recorder.count();
  solution.status = ending.status;
  solution.statistics = position.statistics;
  solution.t_reached = position.t.high;
  solution.y_reached = std::move(position.y);
  solution.message = message_of(ending, solution);
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
  check_times(options.t_eval, t0, t_end);

  Solution solution;
  solution.options = options;
  solution.options.method = find_method(options.method).name;
  solution.options.monitor = nullptr;
  solution.t0 = t0;
  solution.t_end = t_end;
  solution.dimension = static_cast<int>(2 * n);
  Position& start = solution.resumable;
  start.t = {t0, 0.0};
  start.y = q0;
  start.y.insert(start.y.end(), qd0.begin(), qd0.end());
  solution.start = start.y;
  start.dydt.resize(2 * n);
  run(scene, solution, t_end, limits_of(options, t_end), true);
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
  run(scene, longer, t_end, limits, false);
  return longer;
}

}  // namespace pendcore
