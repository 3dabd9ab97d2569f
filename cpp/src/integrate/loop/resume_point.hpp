/// \file
/// Where a continued run restarts, whatever has ended it.
///
/// That is the last position before which nothing was arbitrary: no step was cut for the end of the
/// interval or by an event, and no change of law was left half done.
#pragma once

#include "integrate/loop/integrate.hpp"

namespace pendcore {

class ResumePoint {
 public:
  /// `resumable` becomes the state to resume from; `integrator` is the state of the run.
  /// `discontinuities` may be null.
  ResumePoint(const Stepper& stepper, IntegratorState& integrator, IntegratorState& resumable,
              Observer& observer, const Discontinuities* discontinuities, bool begins_anew);

  /// If the observer may end the run within a step, the state at the start of each step is saved.
  void step_begins();
  /// A continued run takes the whole step again.
  void restart_at_step_start();

  /// Until end_change(), an exception in a user's function leaves the law half changed.
  void begin_change();
  void change_goes_on() { law_is_changing_ = true; }  ///< a second change at the same time
  void end_change() { law_is_changing_ = false; }

  /// What follows depends on where the run ends.
  void cut_from_here();
  /// The resumable position stays what it is.
  void cut() { is_cut_ = true; }
  bool is_cut() const { return is_cut_; }

  /// An exception left the step, or the change of law, half done.
  void interrupt();
  /// The run ends where it stands.
  void end();

 private:
  void keep();
  void write_down(IntegratorState& target) const;

  const Stepper& stepper_;
  IntegratorState& integrator_;
  IntegratorState& resumable_;
  Observer& observer_;
  const Discontinuities* discontinuities_;
  IntegratorState step_start_;
  long long evaluations_before_;
  long long jacobians_before_;
  long long factorisations_before_;
  bool is_cut_;
  bool law_is_changing_ = false;
};

}  // namespace pendcore
