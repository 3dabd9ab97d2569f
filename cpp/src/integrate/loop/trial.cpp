#include "integrate/loop/trial.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"

namespace pendcore {
namespace {

/// Halvings after which a dense output is believed although it contradicts the law where a guard
/// begins at zero.
constexpr int most_halvings_of_step = 20;
/// The dense output of a fixed step locates a guard's zero only roughly: the step is not shortened
/// below this share at once.
constexpr double least_share_of_fixed = 0.1;

/// Whether time resolves nothing within a step of size h at t. Near t = 0 doubles resolve more than
/// steps can: what happens within the least step of a run happens at once.
bool is_short(double h, double t) {
  return std::abs(h) <= std::max(few_bits * last_bits(t, t), least_step);
}

/// The component of the attempted step whose new value, or new rate, is not finite, or -1.
int bad_component_of(Stepper& stepper, double t_new) {
  std::vector<double> y(stepper.dimension());
  std::vector<double> dydt(stepper.dimension());
  stepper.get_new_state(y.data());
  stepper.evaluate(t_new, y.data(), dydt.data());
  y.resize(stepper.controlled());  // quadratures do not affect the steps
  dydt.resize(stepper.controlled());
  return std::max(bad_component(y), bad_component(dydt));
}

}  // namespace

Trial::Trial(Stepper& stepper, IntegratorState& integrator, const Limits& limits,
             Discontinuities* discontinuities)
    : stepper_(stepper),
      integrator_(integrator),
      fixed_step_(limits.fixed_step),
      first_kink_(limits.first_kink) {
  if (discontinuities != nullptr) guards_ = std::make_unique<Guards>(stepper, *discontinuities);
}

void Trial::attempt(double h) {
  t_ = integrator_.t.high;
  h_ = h;
  attempt_ = stepper_.attempt(integrator_.t, h_, integrator_.control.gain(stepper_.info()));
}

Trial::Verdict Trial::judge(bool is_shortest, bool at_any_error) {
  crossing_ = {};
  look_for_bad_component();
  // Before the error is judged: the kink may be its cause, which a step that ends there has not.
  if (first_kink_ && integrator_.trial_was_finite && !is_shortest) {
    const double to_kink = h_ * first_kink_(stepper_, t_, h_);
    if (std::abs(to_kink) < std::abs(h_) && !is_too_small(to_kink, t_)) {
      return try_again_with(to_kink);
    }
  }
  const bool is_accepted = attempt_.squared_error <= 1.0 || fixed_step_ || at_any_error;
  if (!integrator_.trial_was_finite || !is_accepted) {
    return try_again_with(h_ * integrator_.control.reject(stepper_.info(), attempt_));
  }
  return guards_ && !is_shortest ? follow_guards() : Verdict::accepted;
}

/// Shortens the step so that it ends at the first zero of a guard, or before any zero. Zeros that
/// coarse steps do not locate are located by shorter ones.
Trial::Verdict Trial::follow_guards() {
  while (true) {
    const Verdict found = verify_guard_start();
    if (found != Verdict::accepted || crossing_.guard < 0) return found;
    const double bits = last_bits(t_, t_ + h_);
    const Guards::Located located =
        guards_->locate(crossing_, t_, h_, integrator_.control.gain(stepper_.info()), bits);
    if (located.is_found) {
      if (!fixed_step_ && located.attempt.squared_error > 1.0) {
        return try_again_with(located.h *
                              integrator_.control.reject(stepper_.info(), located.attempt));
      }
      h_ = located.h;
      attempt_ = located.attempt;
      look_for_bad_component();
      if (integrator_.trial_was_finite) return Verdict::accepted;
    }
    // A shorter step may resolve what the whole step passed over, such as friction's peak at rest.
    h_ *= std::max(0.5 * crossing_.theta, fixed_step_ ? least_share_of_fixed : 0.0);
    if (is_short(h_, t_)) return Verdict::changes_at_start;
    if (!fixed_step_) return Verdict::is_tried_again;
    if (!take_again()) return try_again_with(h_);
  }
}

/// Halves the step until its dense output begins as the law says. The start of a coarse dense
/// output may be wrong by its own error.
Trial::Verdict Trial::verify_guard_start() {
  for (int halvings = 0;; ++halvings) {
    const bool is_shortest = is_short(h_, t_);
    crossing_ = guards_->first(t_, h_, !is_shortest);
    const double at_start = epsilon * std::max(few_bits * std::abs(t_), 2.0 * std::abs(h_));
    if (crossing_.guard >= 0 && crossing_.theta * std::abs(h_) <= at_start) {
      // A fixed step that is too long for its method shows slopes that the motion does not have.
      if (is_shortest || (crossing_.is_of_slope && !fixed_step_) ||
          guards_->falls_at_start(crossing_.guard, t_, h_, halvings)) {
        return Verdict::changes_at_start;
      }
    } else if (is_shortest || halvings == most_halvings_of_step ||
               !guards_->contradicts_law_at_start(crossing_, h_)) {
      return Verdict::accepted;
    }
    h_ *= 0.5;
    if (!take_again()) return try_again_with(0.5 * h_);
  }
}

/// Attempts the step at its new length, and returns whether it is accepted. A part of a fixed step
/// may become as short as necessary.
bool Trial::take_again() {
  while (true) {
    attempt(h_);
    look_for_bad_component();
    if (!fixed_step_) return integrator_.trial_was_finite && attempt_.squared_error <= 1.0;
    if (integrator_.trial_was_finite) return true;
    if (is_short(h_, t_)) return false;
    h_ *= 0.5;
  }
}

/// Lets a step of size h be tried next, unless all steps have a fixed size.
Trial::Verdict Trial::try_again_with(double h) {
  if (fixed_step_) return Verdict::fails;
  h_ = h;
  return Verdict::is_tried_again;
}

void Trial::look_for_bad_component() {
  const double error = attempt_.squared_error;
  bad_ = -1;
  // The norm overflows beyond the square root of the largest double; this alone is not an error.
  if (!std::isfinite(error)) bad_ = bad_component_of(stepper_, t_ + h_);
  // A fixed step is accepted whatever its error is, so its dense output is checked here.
  if (bad_ < 0 && fixed_step_ && is_far_off()) bad_ = bad_component_between();
  integrator_.trial_was_finite = bad_ < 0 && !std::isnan(error);
}

/// Whether some component is so large that the squares of rates may overflow within four stages.
bool Trial::is_far_off() {
  constexpr double far = 1e15;
  new_state_.resize(stepper_.dimension());
  stepper_.get_new_state(new_state_.data());
  return std::ranges::any_of(new_state_, [](double x) { return std::abs(x) > far; });
}

/// The first component whose dense output is not finite, or -1. The dense output may have stages of
/// its own.
int Trial::bad_component_between() {
  const int size = stepper_.dimension();
  polynomial_.resize(static_cast<std::size_t>(stepper_.interpolant_degree() + 1) * size);
  stepper_.interpolant(h_, polynomial_.data());
  for (std::size_t i = 0; i < polynomial_.size(); ++i) {
    const int component = static_cast<int>(i) % size;
    const bool error_controlled = component < stepper_.controlled();  // quadratures are not
    if (error_controlled && !std::isfinite(polynomial_[i])) return component;
  }
  return -1;
}

}  // namespace pendcore
