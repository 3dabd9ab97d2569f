#include "simulate/checked_options.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "arithmetic/epsilon.hpp"
#include "pendcore/methods.hpp"
#include "text/check.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

/// One number for all components or one for each, none below `least`.
std::vector<double> tolerances(const char* name, const std::vector<double>& given,
                               std::size_t dimension, double least) {
  if (given.size() != 1 && given.size() != dimension) {
    throw std::invalid_argument(std::string(name) + ": has " + std::to_string(given.size()) +
                                " numbers: must have 1, or " + std::to_string(dimension) +
                                " (q_1 .. q_n, qd_1 .. qd_n)");
  }
  std::vector<double> result(dimension, std::max(given.front(), least));
  for (std::size_t i = 1; i < given.size(); ++i) result[i] = std::max(given[i], least);
  return result;
}

}  // namespace

std::vector<double> relative_tolerances(const Options& options, std::size_t n) {
  return tolerances("rtol", options.rtol, 2 * n, 10 * epsilon);
}

std::vector<double> absolute_tolerances(const Options& options, std::size_t n) {
  return tolerances("atol", options.atol, 2 * n, 1e-150);
}

double tightest_tolerance(const Options& options, std::size_t n) {
  const std::vector<double> rtol = relative_tolerances(options, n);
  const std::vector<double> atol = absolute_tolerances(options, n);
  double least = 1.0;
  for (std::size_t i = 0; i < rtol.size(); ++i) least = std::min(least, std::max(rtol[i], atol[i]));
  return least;
}

void check_times(const std::vector<double>& times, double t0, double t_end) {
  const double direction = t_end < t0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!((times[i] - t0) * direction >= 0.0 && (t_end - times[i]) * direction >= 0.0)) {
      refuse("t_eval[" + std::to_string(i) + "]", times[i],
             "within the run, " + text(t0) + " to " + text(t_end) + " s");
    }
    if (i > 0 && !((times[i] - times[i - 1]) * direction > 0.0)) {
      refuse("t_eval[" + std::to_string(i) + "]", times[i],
             "beyond t_eval[" + std::to_string(i - 1) + "] = " + text(times[i - 1]) +
                 (direction < 0.0 && times.front() < times.back()
                      ? ", as t_span runs backward: reverse t_eval, or swap the ends of t_span"
                      : " in the direction of the run: sort the times, each once"));
    }
  }
}

void check(const Options& options) {
  for_each_parameter(
      options, [](const ParameterInfo& info, const auto& value) { check_value("", info, value); });
  if (options.step && options.first_step) {
    throw std::invalid_argument("first_step: a fixed step is given as step: leave one of them out");
  }
  if (options.step && *options.step > options.max_step) {
    refuse("step", *options.step, "<= max_step = " + text(options.max_step) + " (s)");
  }
  const Store store = options.store.value_or(usual_store(options));
  const bool takes_times = store == Store::times || store == Store::dense;
  if (store == Store::times && options.t_eval.empty()) {
    throw std::invalid_argument("t_eval: none given: store = \"times\" keeps the times in it (s)");
  }
  if (!options.t_eval.empty() && !takes_times) {
    throw std::invalid_argument(
        "store = \"" + std::string(store_name(store)) +
        "\": keeps no times of t_eval: must be \"times\" or \"dense\", or leave t_eval out");
  }
  if (options.method == automatic)
    return;  // every method that the rule chooses passes what follows
  const MethodInfo& method = find_method(options.method, automatic);
  if (method.error_order == 0 && !options.step) {
    throw std::invalid_argument("step: none given: method \"" + std::string(method.name) +
                                "\" estimates no error and takes fixed steps: give one, > 0 (s)");
  }
  if (options.compensated && !method.compensates) {
    throw std::invalid_argument(
        "compensated: method \"" + std::string(method.name) +
        "\" cannot carry the rounding error to the next step: leave it out");
  }
}

void check_options(const Scene& scene, const Options& options, double t0, double t_end) {
  check(options);
  for (std::size_t i = 0; i < options.events.size(); ++i) {
    const Event& event = options.events[i];
    check_event(event_name(event, i) + ": ", event, static_cast<int>(scene.links.size()));
  }
  check_times(options.t_eval, t0, t_end);
}

}  // namespace pendcore
