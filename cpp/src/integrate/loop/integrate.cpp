#include "integrate/loop/integrate.hpp"

#include <algorithm>
#include <cmath>

#include "integrate/loop/interruption.hpp"
#include "integrate/loop/resume_point.hpp"
#include "integrate/loop/run_limits.hpp"
#include "integrate/loop/stiffness.hpp"
#include "integrate/loop/trial.hpp"

namespace pendcore {
namespace {

/// Counts an accepted step of size h. A step that was cut does not count for the smallest and the
/// largest step.
void count_accepted(Statistics& statistics, double h, bool cut, bool at_max_step) {
  ++statistics.accepted;
  ++(cut           ? statistics.limited_by_break
     : at_max_step ? statistics.limited_by_max_step
                   : statistics.limited_by_tolerance);
  const long long uncut = statistics.accepted - statistics.limited_by_break;
  if (cut && uncut > 0) return;
  const double size = std::abs(h);
  const bool first = uncut <= 1;
  statistics.min_step = first ? size : std::min(statistics.min_step, size);
  statistics.max_step = first ? size : std::max(statistics.max_step, size);
}

class Run {
 public:
  Run(Stepper& stepper, IntegratorState& integrator, IntegratorState& resumable,
      const Limits& limits, Observer& observer, Discontinuities* discontinuities)
      : stepper_(stepper),
        integrator_(integrator),
        limits_(limits),
        observer_(observer),
        discontinuities_(discontinuities),
        run_limits_(limits, integrator.t.high),
        resume_(stepper, integrator, resumable, observer, discontinuities, limits.begins_anew),
        trial_(stepper, integrator, limits, discontinuities) {
    has_quadratures_ = stepper.controlled() < stepper.dimension();
    if (has_quadratures_ || discontinuities != nullptr) make_room();
    stepper.keep_going = [this] {
      if (can_stop_) stopped_ = run_limits_.look(integrator_.t.high);
      return stopped_ == Status::finished;
    };
  }

  Ending go() {
    // If a law has ended where the run begins, it has ended for a run of no length as well.
    const bool begins = integrator_.h == 0.0;
    if (begins && discontinuities_ != nullptr && discontinuities_->is_over())
      return end_with(Status::non_finite);
    // Where a run goes on, the ledger's rates are not looked at, as in a run that never stopped.
    const int bad = bad_component(integrator_.dydt);
    if (bad >= 0 && (begins || bad < stepper_.controlled())) {
      return end_with(Status::non_finite, bad);
    }
    resume_.step_begins();
    const Interruption found = interruption_of([this] {
      while (!has_ended() && step()) {
      }
    });
    if (found.status == Status::finished) return end_with(status_, bad_ >= 0 ? bad_ : trial_.bad());
    resume_.interrupt();
    Ending ending = end_with(found.status);
    ending.error = found.error;
    return ending;
  }

 private:
  /// A short run that needs neither a state nor a rate of its own has no memory for them.
  void make_room() {
    state_.resize(stepper_.dimension());
    rate_.resize(stepper_.dimension());
  }

  /// The time that the next step may not go beyond.
  struct Target {
    double t;
    double left;    ///< the time until then
    bool is_break;  ///< whether the law changes there; otherwise the interval ends there
    bool is_in_reach;
  };

  /// Each of these functions takes the run a little further and returns whether it goes on. `end`
  /// notes why it does not.
  bool end(Status status) {
    status_ = status;
    return false;
  }

  bool step() {
    const double t = integrator_.t.high;
    // A continued run may be asked to go no further. What is left of its time, less than the last
    // bit, would be a step of its own, perhaps a backward one.
    if (t == limits_.t_end) return end(Status::finished);
    const double left = difference(limits_.t_end, integrator_.t);
    if (attempts_ == limits_.max_steps) return end(Status::max_steps);
    if (const Status clock = run_limits_.look(t); clock != Status::finished) return end(clock);

    resume_.step_begins();
    if (discontinuities_ != nullptr && discontinuities_->is_over()) return end(Status::non_finite);
    if (discontinuities_ != nullptr && discontinuities_->rests()) return rest(left);
    if (discontinuities_ != nullptr && std::abs(integrator_.h) > discontinuities_->longest_step()) {
      integrator_.h = std::copysign(discontinuities_->longest_step(), integrator_.h);
    }
    const Target target = next_target(left);
    double h = integrator_.h;
    const bool resolves_nothing = is_too_small(h, t);
    // If the target is the next time that a double can hold, one step to it may be tried.
    if (resolves_nothing && (!target.is_in_reach || integrator_.control.after_rejection)) {
      const bool is_coarse = integrator_.trial_was_finite || was_stretched_;
      return end(is_coarse ? Status::step_too_small : Status::non_finite);
    }
    was_stretched_ = target.is_in_reach && std::abs(target.left) > last_step_stretch * std::abs(h);
    if (target.is_in_reach) {
      h = target.left;
      if (!target.is_break) resume_.cut_from_here();
    }

    ++attempts_;
    can_stop_ = true;
    trial_.attempt(h);
    can_stop_ = false;  // from here on the step has been tried already
    if (stopped_ != Status::finished) return end(stopped_);
    const bool is_shortest = target.is_in_reach && std::abs(h) <= few_bits * last_bits(t, target.t);
    switch (trial_.judge(is_shortest, is_shortest && !resolves_nothing)) {
      case Trial::Verdict::accepted: break;
      case Trial::Verdict::is_tried_again:
        ++integrator_.statistics.rejected;
        integrator_.h = trial_.h();
        integrator_.h_is_max_step = false;
        return true;
      case Trial::Verdict::changes_at_start:
        --attempts_;  // this was no step, and the statistics do not count it either
        return change_at_once(trial_.guard());
      case Trial::Verdict::fails:
        ++integrator_.statistics.rejected;
        return end(trial_.result().converged ? Status::non_finite : Status::not_converged);
    }
    integrator_.crossings_at_once = 0;
    return accept(target, trial_.guard(), trial_.h(), trial_.result());
  }

  /// Nothing moves any more, so one step leads to the end.
  bool rest(double left) {
    resume_.cut_from_here();
    integrator_.crossings_at_once = 0;
    stepper_.stay();
    const StepEnd last = observer_.step_accepted(stepper_, integrator_.t, left, limits_.t_end);
    if (last.has_too_many_turns()) return end(Status::max_turns);
    if (last.is_within()) return end_within_step(last.theta, left, limits_.t_end);
    stepper_.accept(limits_.t_end);
    integrator_.t = {limits_.t_end, 0.0};
    return end(Status::at_rest);
  }

  Target next_target(double left) const {
    Target target{limits_.t_end, left, false, false};
    if (discontinuities_ != nullptr) {
      const double next = discontinuities_->next_time(integrator_.t.high);
      if ((limits_.t_end - next) * left > 0.0) {
        target = {next, difference(next, integrator_.t), true, false};
      }
    }
    // A stretched step may exceed max_step by the last bits of t, because a step over these bits
    // alone would be no step.
    target.is_in_reach = std::abs(target.left) <= reach(integrator_.h, limits_.max_step) +
                                                      last_bits(integrator_.t.high, target.t);
    return target;
  }
  /// The law changes where the step begins.
  bool change_at_once(int guard) {
    resume_.begin_change();
    if (++integrator_.crossings_at_once > 100 + 4 * discontinuities_->guards()) {
      chatters_ = true;
      return end(Status::step_too_small);
    }
    return change_law(guard);
  }

  /// Quadratures do not affect the steps, so nothing else would report that they overflow.
  bool quadratures_overflow() {
    if (!has_quadratures_) return false;
    stepper_.get_new_state(state_.data());
    bad_ = bad_component(state_);
    return bad_ >= 0;
  }

  bool accept(const Target& target, int guard, double h, const Attempt& attempt) {
    if (quadratures_overflow()) return end(Status::non_finite);
    TwoDouble t_new = integrator_.t + h;
    // A guard's zero within the last bits of the target counts as at the target.
    const bool is_at_target = target.is_in_reach && lands(h, difference(target.t, t_new),
                                                          last_bits(integrator_.t.high, target.t));
    if (is_at_target) t_new = {target.t, 0.0};
    const bool law_changes = guard >= 0 || (is_at_target && target.is_break);
    if (law_changes) resume_.begin_change();
    test_stiffness(stepper_, h, integrator_);
    if (guard >= 0 || (discontinuities_ != nullptr && discontinuities_->settles_every_step())) {
      stepper_.get_new_state(state_.data());
      if (discontinuities_->settle(guard, state_.data())) stepper_.set_new_state(state_.data());
    }
    const StepEnd last = observer_.step_accepted(stepper_, integrator_.t, h, t_new.high);
    if (last.has_too_many_turns()) {
      resume_.restart_at_step_start();
      return end(Status::max_turns);
    }
    const bool is_cut = target.is_in_reach || h != integrator_.h || law_changes;
    count_accepted(integrator_.statistics, h, is_cut, integrator_.h_is_max_step);
    if (last.is_within()) return end_within_step(last.theta, h, t_new.high);
    // Before accept(), where a user's function may throw: the observer has kept the step already.
    integrator_.t = t_new;
    stepper_.accept(t_new.high);
    if (!law_changes) {
      if (discontinuities_ != nullptr) discontinuities_->step_taken();
      if (limits_.fixed_step) return true;
      integrator_.h = h * integrator_.control.accept(stepper_.info(), attempt);
      integrator_.h_is_max_step = std::abs(integrator_.h) >= limits_.max_step;
      integrator_.h = limited(integrator_.h, limits_.max_step);
      return true;
    }
    if (guard >= 0 && !change_law(guard)) return false;
    return is_at_target && target.is_break ? change_law(-1) : true;
  }

  /// An event lies within the step. The clipped state is for output only, and resume repeats the
  /// step.
  bool end_within_step(double theta, double h, double t_new) {
    const TwoDouble t = time_in_step(integrator_.t, h, theta, t_new);
    // Within the last bits of the start no time has passed, and one time has only one state.
    if (t.high == integrator_.t.high) return true;
    const std::size_t rows = stepper_.interpolant_degree() + 1;
    std::vector<double> polynomial(rows * stepper_.dimension());
    stepper_.finite_interpolant(h, polynomial, stepper_.dimension());
    make_room();
    stepper_.state_within(polynomial.data(), theta, state_.data());
    stepper_.get_derivative(rate_.data());
    stepper_.start(state_.data(), rate_.data());
    integrator_.t = t;
    return true;
  }
  /// An event ended the run. A run that goes on takes the whole step again.
  bool has_ended() {
    if (!observer_.has_ended()) return false;
    resume_.restart_at_step_start();
    status_ = Status::event;
    return true;
  }

  /// Changes the law at the state that the stepper has reached. The step that was to be tried is
  /// tried next.
  bool change_law(int guard) {
    resume_.change_goes_on();
    const double t = integrator_.t.high;
    stepper_.get_state(state_.data());
    const std::vector<double> before = state_;
    const bool jumped = discontinuities_->cross(guard, t, state_.data());
    bad_ = bad_component(state_);
    if (bad_ >= 0) {  // the run ends with the state before
      resume_.cut();
      return end(Status::non_finite);
    }
    if (jumped) {
      observer_.state_jumped(t, before.data(), state_.data());
    } else if (state_ != before) {
      observer_.state_settled(t, state_.data());
    }
    stepper_.evaluate(t, state_.data(), rate_.data());
    stepper_.start(state_.data(), rate_.data());
    integrator_.control = StepControl{};
    resume_.end_change();
    // The ledger's rates are checked too, as at the beginning of a run: no step's error would show
    // that they are not finite.
    bad_ = bad_component(rate_);
    return bad_ < 0 || end(Status::non_finite);
  }

  Ending end_with(Status status, int bad = -1) {
    resume_.end();
    return Ending{.status = status,
                  .cut = resume_.is_cut(),
                  .bad = status == Status::non_finite ? bad : -1,
                  .chatters = chatters_};
  }

  Stepper& stepper_;
  IntegratorState& integrator_;
  const Limits& limits_;
  Observer& observer_;
  Discontinuities* discontinuities_;
  RunLimits run_limits_;
  ResumePoint resume_;
  Trial trial_;
  Status status_ = Status::finished;
  bool can_stop_ = false;
  Status stopped_ = Status::finished;  ///< why an attempt was given up, if it was
  long long attempts_ = 0;
  bool chatters_ = false;
  bool was_stretched_ = false;  ///< whether the last attempt was lengthened to reach its target
  bool has_quadratures_ = false;
  int bad_ = -1;  ///< component of the last trial, while trials are not finite
  std::vector<double> state_;
  std::vector<double> rate_;
};

}  // namespace

int bad_component(const std::vector<double>& y) {
  const auto bad = std::ranges::find_if(y, [](double x) { return !std::isfinite(x); });
  return bad == y.end() ? -1 : static_cast<int>(bad - y.begin());
}

Ending integrate(Stepper& stepper, IntegratorState& integrator, IntegratorState& resumable,
                 const Limits& limits, Observer& observer, Discontinuities* discontinuities) {
  return Run(stepper, integrator, resumable, limits, observer, discontinuities).go();
}

}  // namespace pendcore
