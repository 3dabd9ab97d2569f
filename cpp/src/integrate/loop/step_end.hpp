/// \file
/// The answer of an Observer to an accepted step: where in the step the run is to end, if anywhere.
#pragma once

namespace pendcore {

struct StepEnd {
  enum class Kind {
    whole,           ///< the run takes the step to its end
    within,          ///< an event ends the run at the share theta of the step, below 1
    too_many_turns,  ///< the step has events in too many turns: nothing was kept of it
  };
  Kind kind = Kind::whole;
  double theta = 1.0;

  /// An event that ends the run at the end of the step leaves the step whole.
  static constexpr StepEnd at(double theta) {
    return theta < 1.0 ? StepEnd{Kind::within, theta} : StepEnd{};
  }
  static constexpr StepEnd too_many_turns() { return {Kind::too_many_turns, 0.0}; }

  constexpr bool is_within() const { return kind == Kind::within; }
  constexpr bool has_too_many_turns() const { return kind == Kind::too_many_turns; }
};

}  // namespace pendcore
