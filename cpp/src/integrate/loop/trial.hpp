/// \file
/// The trial of a step. If the law changes along the step, it is shortened to end at this time.
///
/// The law is frozen while the method tries a step, and Guards finds where along the step this was
/// not allowed. The step is then taken again up to that time, so that the state there comes from
/// the method, not from the dense output. Where a coarse step does not decide about a guard, a
/// shorter one is tried.
#pragma once

#include <memory>
#include <vector>

#include "integrate/loop/guards.hpp"
#include "integrate/loop/integrate.hpp"

namespace pendcore {

class Trial {
 public:
  /// What happens with the step.
  enum class Verdict {
    accepted,          ///< with size h(); the law changes at its end if guard() is not -1
    is_tried_again,    ///< from its start, with size h()
    changes_at_start,  ///< guard() is negative as soon as the step begins
    fails              ///< and no other size is tried
  };

  /// Tries steps of `integrator` and sets its `trial_was_finite`; `discontinuities` may be null.
  Trial(Stepper& stepper, IntegratorState& integrator, const Limits& limits,
        Discontinuities* discontinuities);

  /// Lets the method attempt a step of size h.
  void attempt(double h);
  /// Decides what follows from the attempt. The shortest of all steps cannot be shortened. If the
  /// error of such a step only comes from the rounding of its times, it is accepted `at_any_error`.
  Verdict judge(bool is_shortest, bool at_any_error);

  double h() const { return h_; }
  int guard() const { return crossing_.guard; }
  const Attempt& result() const { return attempt_; }
  /// The component whose new value or rate is not finite, or -1.
  int bad() const { return bad_; }

 private:
  Verdict follow_guards();
  Verdict verify_guard_start();
  bool take_again();
  Verdict try_again_with(double h);
  void look_for_bad_component();
  bool is_far_off();
  int bad_component_between();

  Stepper& stepper_;
  IntegratorState& integrator_;
  bool fixed_step_;
  const FirstKink& first_kink_;
  std::unique_ptr<Guards> guards_;  ///< null without discontinuities
  double t_ = 0.0;
  double h_ = 0.0;
  Attempt attempt_{};
  Crossing crossing_;
  int bad_ = -1;
  std::vector<double> new_state_;
  std::vector<double> polynomial_;  ///< the dense output of a fixed step
};

}  // namespace pendcore
