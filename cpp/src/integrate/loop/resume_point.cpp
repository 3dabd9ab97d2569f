#include "integrate/loop/resume_point.hpp"

namespace pendcore {

ResumePoint::ResumePoint(const Stepper& stepper, IntegratorState& integrator,
                         IntegratorState& resumable, Observer& observer,
                         const Discontinuities* discontinuities, bool begins_anew)
    : stepper_(stepper),
      integrator_(integrator),
      resumable_(resumable),
      observer_(observer),
      discontinuities_(discontinuities),
      evaluations_before_(stepper.evaluations - integrator.statistics.nfev),
      jacobians_before_(stepper.jacobians - integrator.statistics.njev),
      factorisations_before_(stepper.factorisations - integrator.statistics.nlu),
      is_cut_(begins_anew) {}

void ResumePoint::step_begins() {
  if (!observer_.may_end()) return;
  write_down(step_start_);
  observer_.step_begins();
}

void ResumePoint::restart_at_step_start() {
  if (!is_cut_) {
    resumable_ = step_start_;
    observer_.restarts_at_step();
  }
  is_cut_ = true;
}

void ResumePoint::keep() {
  if (is_cut_) return;
  write_down(resumable_);
  observer_.restarts_here();
}

void ResumePoint::begin_change() {
  keep();
  law_is_changing_ = true;
}

void ResumePoint::cut_from_here() {
  keep();
  is_cut_ = true;
}

void ResumePoint::interrupt() {
  if (observer_.may_end()) {
    restart_at_step_start();
  } else {
    is_cut_ = is_cut_ || law_is_changing_;
  }
}

void ResumePoint::end() {
  write_down(integrator_);
  if (!is_cut_) resumable_ = integrator_;
}

void ResumePoint::write_down(IntegratorState& target) const {
  target = integrator_;
  target.statistics.nfev = stepper_.evaluations - evaluations_before_;
  target.statistics.njev = stepper_.jacobians - jacobians_before_;
  target.statistics.nlu = stepper_.factorisations - factorisations_before_;
  stepper_.get_state(target.y.data());
  stepper_.get_derivative(target.dydt.data());
  target.stepper = stepper_.saved_state();
  if (discontinuities_ != nullptr) target.discontinuities = discontinuities_->saved_state();
}

}  // namespace pendcore
