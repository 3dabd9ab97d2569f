#include "pendcore/simulate/options.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "pendcore/arithmetic/epsilon.hpp"
#include "pendcore/integrate/methods.hpp"
#include "pendcore/text/message.hpp"

namespace pendcore {
namespace {

bool is_within(const NumberRange& range, double value) {
  if (!(range.includes_infinity || std::isfinite(value))) return false;
  return value > range.least || (range.includes_least && value == range.least);
}

/// One number for all components or one for each, none below `least`.
std::vector<double> tolerances(const OptionInfo& info, const std::vector<double>& given,
                               std::size_t dimension, double least) {
  if (given.size() != 1 && given.size() != dimension) {
    throw std::invalid_argument(std::string(info.name) + ": has " + std::to_string(given.size()) +
                                " numbers: must have 1, or " + std::to_string(dimension) +
                                " (q_1 .. q_n, qd_1 .. qd_n)");
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (is_within(info.range, given[i])) continue;
    const std::string index = given.size() == 1 ? "" : "[" + std::to_string(i) + "]";
    refuse(std::string(info.name) + index, given[i], range_with_unit(info));
  }
  std::vector<double> result(dimension, std::max(given.front(), least));
  for (std::size_t i = 1; i < given.size(); ++i) result[i] = std::max(given[i], least);
  return result;
}

void check_range(const OptionInfo& info, double value) {
  if (!is_within(info.range, value)) refuse(std::string(info.name), value, range_with_unit(info));
}

void check_range(const OptionInfo& info, const std::optional<double>& value) {
  if (value) check_range(info, *value);
}

void check_range(const OptionInfo& info, long long value) {
  if (is_within(info.range, static_cast<double>(value))) return;
  throw std::invalid_argument(std::string(info.name) + " = " + std::to_string(value) +
                              ": must be " + range_with_unit(info));
}

template <class Other>
void check_range(const OptionInfo& /*info*/, const Other& /*value*/) {}

}  // namespace

std::vector<double> relative_tolerances(const Options& options, std::size_t n) {
  return tolerances(RtolOption::info, options.rtol, 2 * n, 10 * epsilon);
}

std::vector<double> absolute_tolerances(const Options& options, std::size_t n) {
  return tolerances(AtolOption::info, options.atol, 2 * n, 1e-150);
}

void check_times(const std::vector<double>& times, double t0, double t_end) {
  const double direction = t_end < t0 ? -1.0 : 1.0;
  if (times.empty()) return;
  // If times are in order and the first and the last lie within the run, all do. Only otherwise is
  // the wrong one looked for.
  bool is_right =
      (times.front() - t0) * direction >= 0.0 && (t_end - times.back()) * direction >= 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    is_right &= (times[i] - times[i - 1]) * direction > 0.0;
  }
  if (is_right) return;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!((times[i] - t0) * direction >= 0.0 && (t_end - times[i]) * direction >= 0.0)) {
      refuse("t_eval[" + std::to_string(i) + "]", times[i],
             "within t_span, " + text(t0) + " to " + text(t_end) + " s");
    }
    if (i > 0 && !((times[i] - times[i - 1]) * direction > 0.0)) {
      refuse("t_eval[" + std::to_string(i) + "]", times[i],
             "beyond t_eval[" + std::to_string(i - 1) + "] = " + text(times[i - 1]) +
                 " in the direction of the run: sort the times, each once");
    }
  }
}

void check(const Options& options) {
  Options::for_each([&]<class Option>() { check_range(Option::info, options.*Option::field); });
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
        "\" cannot carry the rounding error to the next step: must be False");
  }
}

}  // namespace pendcore
