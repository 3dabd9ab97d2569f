/// \file
/// The loop over steps, from where a run stands to the end of its interval.
///
/// The loop knows no method (a Stepper does) and no pendulum. An Observer keeps what is asked for
/// of the steps, and changes none of them.
#pragma once

#include <exception>
#include <functional>
#include <limits>
#include <vector>

#include "arithmetic/two_double.hpp"
#include "integrate/loop/discontinuities.hpp"
#include "integrate/loop/step_control.hpp"
#include "integrate/stepper.hpp"
#include "pendcore/status.hpp"

namespace pendcore {

/// Everything the next step depends on: a run that goes on from here takes the very steps that it
/// would have taken had it never stopped.
struct IntegratorState {
  TwoDouble t;
  double h = 0.0;  ///< s, the step to try next; its sign is the direction
  bool h_is_max_step = false;
  bool trial_was_finite = true;  ///< the last step that was tried
  int crossings_at_once = 0;     ///< laws that changed since the last step
  StepControl control;
  int stiff_hits = 0;        ///< hits of Hairer's test for stiffness since its last six misses
  int stiff_misses = 0;      ///< since the last hit
  double stiff_since = 0.0;  ///< s, when the run was first called stiff; for a pair, when last
  Statistics statistics;
  std::vector<double> y;     ///< (dimension)
  std::vector<double> dydt;  ///< (dimension)
  StepperState stepper;
  std::vector<double> discontinuities;  ///< Discontinuities::saved_state()
};

/// The share of an attempted step of size h from time t, s, at which a derivative of the motion
/// jumps that the error of a step does not show; 1 if none does.
using FirstKink = std::function<double(const Stepper& attempted, double t, double h)>;

struct Limits {
  double t_end;
  double max_step = std::numeric_limits<double>::infinity();  ///< s
  bool fixed_step = false;  ///< every step has the size h of the state, whatever its error
  long long max_steps = std::numeric_limits<long long>::max();  ///< attempted, accepted or not
  double time_limit = std::numeric_limits<double>::infinity();  ///< s, of the clock on the wall
  Monitor monitor;
  FirstKink first_kink = {};  ///< steps end there; none if empty
  bool begins_anew = false;   ///< a continued run begins at the start again
};

/// Where in an accepted step the run is to end, if anywhere.
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

/// Called for each accepted step before the state advances.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Returns where in the step the run is to end, if an event ends it there.
  virtual StepEnd step_accepted(StepOutput& step, const TwoDouble& t_old, double h,
                                double t_new) = 0;
  /// At the end of that step, time t, the state jumped.
  virtual void state_jumped(double t, const double* before, const double* after) = 0;
  /// There, its last bits were set to what holds exactly.
  virtual void state_settled(double /*t*/, const double* /*after*/) {}
  /// If the run ends now, a continued run restarts here, because later steps may be cut or undone.
  virtual void restarts_here() = 0;

  /// Whether the observer may end the run, by an event or an exception. The loop then saves the
  /// state at the start of each step and calls step_begins(). A continued run takes the last step
  /// again; restarts_at_step() says so.
  virtual bool may_end() const { return false; }
  virtual void step_begins() {}
  virtual void restarts_at_step() {}
  /// Whether the run is to end at the end of this step, or at this jump.
  virtual bool has_ended() const { return false; }
};

/// The time at a share theta of a step of size h from t_old; never beyond its end.
inline TwoDouble time_in_step(const TwoDouble& t_old, double h, double theta, double t_new) {
  const TwoDouble t = t_old + theta * h;
  return difference(t_new, t) * h < 0.0 ? TwoDouble{t_new, 0.0} : t;
}

struct Ending {
  Status status;
  bool cut;      ///< the last step, or one before it, was cut to end at t_end
  int bad = -1;  ///< of status non_finite: the component that is not finite, if it is known
  std::exception_ptr error = nullptr;  ///< of status callback_error
  bool chatters = false;  ///< the law changes back and forth at one time: no step gets further
};

/// The first component that is not finite, or -1.
int bad_component(const std::vector<double>& y);

/// Takes steps from `integrator` (which moves along) until `limits` ends them. `resumable` becomes
/// the last state before which no step was cut. `discontinuities` is null where the right-hand side
/// is smooth.
Ending integrate(Stepper& stepper, IntegratorState& integrator, IntegratorState& resumable,
                 const Limits& limits, Observer& observer,
                 Discontinuities* discontinuities = nullptr);

}  // namespace pendcore
