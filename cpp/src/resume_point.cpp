#include "pendcore/integrate/resume_point.hpp"

namespace pendcore {

ResumePoint::ResumePoint(const Stepper& stepper, Position& position, Position& resumable,
                         Observer& observer, const Breaks* breaks, bool begins_anew)
    : stepper_(stepper),
      position_(position),
      resumable_(resumable),
      observer_(observer),
      breaks_(breaks),
      evaluations_before_(stepper.evaluations - position.statistics.nfev),
      jacobians_before_(stepper.jacobians - position.statistics.njev),
      factorisations_before_(stepper.factorisations - position.statistics.nlu),
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
  write_down(position_);
  if (!is_cut_) resumable_ = position_;
}

void ResumePoint::write_down(Position& target) const {
  target = position_;
  target.statistics.nfev = stepper_.evaluations - evaluations_before_;
  target.statistics.njev = stepper_.jacobians - jacobians_before_;
  target.statistics.nlu = stepper_.factorisations - factorisations_before_;
  stepper_.get_state(target.y.data());
  stepper_.get_derivative(target.dydt.data());
  target.stepper = stepper_.memory();
  if (breaks_ != nullptr) target.breaks = breaks_->memory();
}

}  // namespace pendcore
