/// \file
/// A step as it is tried: shortened, where the law changes along it, to the time at which it does.
///
/// The law is frozen while the method tries a step, and Guards says where along it that was not
/// allowed. The step is then taken again to that time, so that the state there comes from the
/// method, not from the dense output. What a step says of guards that coarse steps cannot tell, a
/// shorter one is asked.
#pragma once

#include <memory>
#include <vector>

#include "pendcore/integrate/loop/guards.hpp"
#include "pendcore/integrate/loop/integrate.hpp"

namespace pendcore {

/// How far apart doubles are about there, and a little more: times within that are the same.
double last_bits(double t, double t_new);
/// How many of the last bits of time a step has that resolves nothing, at most.
inline constexpr double few = 10.0;

class Trial {
 public:
  /// What is to become of the step.
  enum class Verdict {
    accepted,          ///< of size h(); at its end the law changes if guard() is not -1
    is_tried_again,    ///< from its start, of size h()
    changes_at_start,  ///< guard() is negative as soon as the step begins
    fails              ///< and no other size is to be tried
  };

  /// Steps of `integrator`, whose `trial_was_finite` it keeps; `discontinuities` may be null.
  Trial(Stepper& stepper, IntegratorState& integrator, bool fixed_step,
        Discontinuities* discontinuities);

  /// The method's attempt at a step of size h.
  void attempt(double h);
  /// What follows from it. The shortest of all steps cannot be shortened; where longer ones are
  /// what the error calls for, that of this one is that of its times, and it stands `at_any_error`.
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
  Verdict give_up(double h);
  void look_for_bad_component();
  bool is_far_off();
  int bad_component_between();

  Stepper& stepper_;
  IntegratorState& integrator_;
  bool fixed_step_;
  std::unique_ptr<Guards> guards_;  ///< null where nothing discontinuities
  double t_ = 0.0;
  double h_ = 0.0;
  Attempt attempt_{};
  Crossing crossing_;
  int bad_ = -1;
  std::vector<double> new_state_;
  std::vector<double> polynomial_;  ///< of a fixed step
};

}  // namespace pendcore
