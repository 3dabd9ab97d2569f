/// \file
/// How a run is made: method, tolerances, what is kept, and where it ends at the latest.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "pendcore/descriptor.hpp"
#include "pendcore/events.hpp"
#include "pendcore/status.hpp"
#include "pendcore/vector.hpp"

namespace pendcore {

/// A run keeps what its mode says: the last one everything; the first two need constant memory.
enum class Store {
  end,    ///< the end
  times,  ///< the times asked for
  steps,  ///< every accepted step
  dense,  ///< the polynomials, with the times asked for or else with every accepted step
};

inline constexpr std::array<std::string_view, 4> store_names = {"end", "times", "steps", "dense"};

constexpr std::string_view store_name(Store store) {
  return store_names[static_cast<std::size_t>(store)];
}

/// The mode of that name, if there is one.
constexpr std::optional<Store> find_store(std::string_view name) {
  for (std::size_t i = 0; i < store_names.size(); ++i) {
    if (store_names[i] == name) return static_cast<Store>(i);
  }
  return std::nullopt;
}
/// What a message says where no mode has the given name.
inline constexpr std::string_view must_be_store = R"(must be "dense", "steps", "times" or "end")";

/// The method of a run that names none: the descriptor of `method` has the rule.
inline constexpr std::string_view automatic = "auto";

class StepWatch;

/// The tolerance of all 2n components of the state, or one for each.
class Tolerance : public NumberList {
 public:
  using NumberList::NumberList;
  Tolerance(double one) : NumberList{one} {}  // NOLINT(google-explicit-constructor)
};

/// Kept with the solution, so that it can be resumed. `parameters` says what each field means.
struct Options {
  std::string method{automatic};
  Tolerance rtol = 1e-9;
  Tolerance atol = 1e-12;  ///< rad, rad/s
  NumberList t_eval = {};  ///< strictly monotone along the run
  std::optional<Store> store = {};
  std::optional<double> first_step = {};
  double max_step = std::numeric_limits<double>::infinity();
  std::optional<double> step = {};
  long long max_steps = 10'000'000;
  std::optional<double> time_limit = {};
  std::vector<Event> events = {};
  bool ledger = false;
  bool compensated = false;

  Monitor monitor = {};
  StepWatch* watch = nullptr;  ///< the core's own; null

  /// In the order of Python's signature.
  static constexpr auto parameters = std::tuple{
      parameter(
          &Options::method,
          {.name = "method",
           .sentence =
               "``\"auto\"`` chooses by scene and tolerances; ``sol.method`` says which method it "
               "chose. A run in fixed steps takes ``\"dopri5\"``. Two links or more whose effects "
               "all have Taylor series take ``\"taylor-radau5\"``. Other scenes take "
               "``\"dop853-radau5\"``, or ``\"dopri5-radau5\"`` where ``max(rtol, atol)`` is 1e-6 "
               "or more in all components. Each of these pairs gives the bits of its first method "
               "until stability limits the steps and ``\"radau5\"`` can take steps ten times as "
               "long; the run then continues with ``\"radau5\"``."
               "\n{methods}",
           .chosen_for_error = true}),
      parameter(&Options::rtol,
                {.name = "rtol",
                 .sentence = "The error of a step is kept below ``atol + rtol abs(y)``, in root "
                             "mean square over ``y = (q, qd)``. A Taylor series has no error "
                             "estimate: its last coefficients choose the step.",
                 .range = Range::positive,
                 .type = "float or (2n,)",
                 .one_may_stand_for_all = true,
                 .chosen_for_error = true}),
      parameter(&Options::atol, {.name = "atol",
                                 .unit = "rad, rad/s",
                                 .sentence = "The absolute part of that bound.",
                                 .range = Range::not_negative,
                                 .type = "float or (2n,)",
                                 .one_may_stand_for_all = true,
                                 .chosen_for_error = true}),
      parameter(
          &Options::t_eval,
          {.name = "t_eval",
           .unit = "s",
           .sentence =
               "Times of the result, one or more, within the run and in its order. They do not "
               "change the steps. Times that the run does not reach are missing from the result.",
           .type = "array_like, (k,)",
           .if_none = "every step"}),
      parameter(
          &Options::store,
          {.name = "store",
           .sentence =
               "Which states the run keeps. ``\"dense\"`` keeps every step with its interpolant, "
               "``\"steps\"`` every step, ``\"times\"`` only those of ``t_eval``, and ``\"end\"`` "
               "only the last. The last two take constant memory.",
           .type = "{\"dense\", \"steps\", \"times\", \"end\"}",
           .if_none = "``\"times\"`` with ``t_eval``, otherwise ``\"dense\"``"}),
      parameter(
          &Options::first_step,
          {.name = "first_step",
           .unit = "s",
           .sentence = "The step to try first.",
           .range = Range::positive,
           .if_none = "Hairer's rule chooses it from the start, or the first Taylor series does"}),
      parameter(&Options::max_step, {.name = "max_step",
                                     .unit = "s",
                                     .sentence = "No step is longer.",
                                     .range = Range::positive_or_infinite,
                                     .limits_every_method = true}),
      parameter(
          &Options::step,
          {.name = "step",
           .unit = "s",
           .sentence =
               "A fixed step in place of the tolerances. It excludes ``first_step`` and a smaller "
               "``max_step``. An implicit method still solves its equations to the tolerances.",
           .range = Range::positive,
           .if_none = "steps by the tolerances",
           .chosen_for_error = true}),
      parameter(
          &Options::max_steps,
          {.name = "max_steps",
           .sentence = "The run ends with status ``max_steps`` after this many attempted steps.",
           .range = Range::count}),
      parameter(&Options::time_limit, {.name = "time_limit",
                                       .unit = "s",
                                       .sentence = "Wall-clock time, after which the run ends with "
                                                   "status ``time_limit`` and keeps what it has.",
                                       .range = Range::positive_or_infinite,
                                       .if_none = "no limit"}),
      parameter(
          &Options::events,
          {.name = "events",
           .sentence = "Events to look for; ``sol.events`` has a list for each. Events change no "
                       "step. A ``terminal`` event ends the run, with status ``event``.",
           .type = "iterable of pendcore.events.Event"}),
      parameter(
          &Options::ledger,
          {.name = "ledger",
           .sentence = "Whether ``sol.energy().ledger`` has the work and loss of every effect. "
                       "They are integrated beside the state and change no bit of it."}),
      parameter(&Options::compensated,
                {.name = "compensated",
                 .sentence = "Whether each step carries the rounding error of the state over to "
                             "the next step (compensated summation), for long runs at small steps. "
                             "``docs/background/long_runs.md`` says when that pays."}),
  };
};

}  // namespace pendcore
