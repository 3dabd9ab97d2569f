/// \file
/// How far a run is, what it cost, and why it ended, with a sentence for the user.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string_view>

namespace pendcore {

/// Is called about every 50 ms with the share of the interval that is done; false stops the run.
using Monitor = std::function<bool(double fraction)>;

/// The cost of a run.
struct Statistics {
  long long nfev = 0;  ///< right-hand sides
  long long njev = 0;  ///< Jacobians (implicit methods)
  long long nlu = 0;   ///< factorisations (implicit methods)
  long long accepted = 0;
  long long rejected = 0;
  /// Accepted steps whose size the error control chose, or a kink of drag.
  long long limited_by_tolerance = 0;
  long long limited_by_max_step = 0;  ///< accepted steps of max_step, or of a fixed step
  long long limited_by_break = 0;     ///< accepted steps cut by the end or by a break point
  double min_step = 0.0;              ///< s, the smallest accepted step, not cut (unless all are)
  double max_step = 0.0;              ///< s, the largest, likewise
  bool stiff = false;                 ///< stability, not accuracy, was found to limit the steps
};

enum class Status {
  finished,
  event,
  at_rest,
  max_steps,
  max_turns,
  step_too_small,
  not_converged,
  non_finite,
  time_limit,
  interrupted,
  callback_error,
};

struct StatusText {
  std::string_view name;
  bool success;
  std::string_view sentence;  ///< what happened, and what can be done about it
};

inline constexpr std::array<StatusText, 11> status_texts = {{
    {"finished", true, "reached the end of the interval"},
    {"event", true, "stopped at a terminal event"},
    {"at_rest", true, "came to rest for good, and stayed as it is to the end of the interval"},
    {"max_steps", false,
     "the cap on steps was reached: raise max_steps, shorten the interval or allow larger errors"},
    {"max_turns", false, "events with every_turn were looked for in too many turns"},
    {"step_too_small", false,
     "the step fell below what time can resolve: the motion blows up here (or rtol and atol are "
     "too loose to follow it), they are too tight, or t0 is so large that t + h = t"},
    {"not_converged", false,
     "the equations of a step could not be solved: use a smaller step, or omit step for adaptive "
     "stepping"},
    {"non_finite", false,
     "the motion stopped being finite: check parameters and start, and that step, rtol and atol "
     "are not too coarse"},
    {"time_limit", false, "the time limit was reached: raise time_limit, or resume the solution"},
    {"interrupted", false, "interrupted: what was computed so far is kept and can be resumed"},
    {"callback_error", false, "a function of the user's raised an exception"},
}};

constexpr const StatusText& text(Status status) {
  return status_texts[static_cast<std::size_t>(status)];
}

/// The status of that name, if there is one.
constexpr std::optional<Status> find_status(std::string_view name) {
  for (std::size_t i = 0; i < status_texts.size(); ++i) {
    if (status_texts[i].name == name) return static_cast<Status>(i);
  }
  return std::nullopt;
}

}  // namespace pendcore
