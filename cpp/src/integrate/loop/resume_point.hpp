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
              Observer& observer, const Discontinuities* discontinuities, bool begins_anew)
      : stepper_(stepper),
        integrator_(integrator),
        resumable_(resumable),
        observer_(observer),
        discontinuities_(discontinuities),
        evaluations_before_(stepper.evaluations - integrator.statistics.nfev),
        jacobians_before_(stepper.jacobians - integrator.statistics.njev),
        factorisations_before_(stepper.factorisations - integrator.statistics.nlu),
        is_cut_(begins_anew) {}

  /// If the observer may end the run within a step, the state at the start of each step is saved.
  void step_begins() {
    if (!observer_.may_end()) return;
    write_down(step_start_);
    observer_.step_begins();
  }
  /// A continued run takes the whole step again.
  void restart_at_step_start() {
    if (!is_cut_) {
      resumable_ = step_start_;
      observer_.restarts_at_step();
    }
    is_cut_ = true;
  }

  /// Until end_change(), an exception in a user's function leaves the law half changed.
  void begin_change() {
    keep();
    law_is_changing_ = true;
  }
  void change_goes_on() { law_is_changing_ = true; }  ///< a second change at the same time
  void end_change() { law_is_changing_ = false; }

  /// What follows depends on where the run ends.
  void cut_from_here() {
    keep();
    is_cut_ = true;
  }
  /// The resumable position stays what it is.
  void cut() { is_cut_ = true; }
  bool is_cut() const { return is_cut_; }

  /// An exception left the step, or the change of law, half done.
  void interrupt() {
    if (observer_.may_end()) {
      restart_at_step_start();
    } else {
      is_cut_ = is_cut_ || law_is_changing_;
    }
  }
  /// The run ends where it stands.
  void end() {
    write_down(integrator_);
    if (!is_cut_) resumable_ = integrator_;
  }

 private:
  void keep() {
    if (is_cut_) return;
    write_down(resumable_);
    observer_.restarts_here();
  }
  void write_down(IntegratorState& target) const {
    target = integrator_;
    target.statistics.nfev = stepper_.evaluations - evaluations_before_;
    target.statistics.njev = stepper_.jacobians - jacobians_before_;
    target.statistics.nlu = stepper_.factorisations - factorisations_before_;
    stepper_.get_state(target.y.data());
    stepper_.get_derivative(target.dydt.data());
    target.stepper = stepper_.saved_state();
    if (discontinuities_ != nullptr) target.discontinuities = discontinuities_->saved_state();
  }

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
