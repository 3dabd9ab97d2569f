/// \file
/// Where a right-hand side is not smooth, as the loop sees it: times that no step may cross, and
/// guards, which are functions of time and state that stay positive until the law changes.
///
/// While a step is taken the law is frozen, so that method and error estimate see a smooth
/// function. The loop cuts the step that would make a guard negative at the guard's zero, redoes it
/// to the last bits of that time, and asks for the law that follows. The state may jump there.
#pragma once

#include <vector>

namespace pendcore {

class Discontinuities {
 public:
  virtual ~Discontinuities() = default;

  /// The next time after t, in the run's direction, that no step may cross; infinite if none.
  virtual double next_time(double t) const = 0;
  /// The longest step that cannot miss the cause of a guard's change: the load on a held joint does
  /// not show in the error of a step. Infinite if there is no such load.
  virtual double longest_step() const = 0;

  /// Guards are numbered from 0; the first `linear_guards()` of them are linear in the state.
  virtual int guards() const = 0;
  virtual int linear_guards() const = 0;
  /// The multiplicity of the zero that a guard has at the start of the next step: how many of its
  /// value, slope and curvature are zero, whatever rounding makes of them. It is 0 for a guard that
  /// is not linear.
  virtual int multiplicity_at_start(int k) const = 0;
  /// The coefficients of a linear guard along the dense output, a polynomial given by (degree + 1)
  /// rows of `dimension` numbers.
  virtual void polynomial(int k, const double* rows, int degree, int dimension,
                          double* coefficients) const = 0;
  virtual double guard(int k, const double* y) const = 0;
  /// The slope, 1/s, that a guard on a rate would have if the joint were at rest, even if it turns
  /// in the given state; NaN for any other guard. Errors of the rate do not affect this slope. If
  /// the guard would rise there, it cannot have fallen through zero.
  virtual double slope_at_rest(int k, double t, const double* y) = 0;
  /// How far a guard's value can be off by the rounding of the state.
  virtual double rounding(int k, const double* y) const = 0;
  /// Computes the values of the other guards.
  virtual void other_guards(double t, const double* y, double* values) = 0;

  /// Whether settle() is to be called at the end of every step, not only at guards.
  virtual bool settles_every_step() const = 0;
  /// Adjusts the state at the end of a step to what holds there exactly, such as the zero of guard
  /// k (-1 if the step ends at no guard). Returns whether it changed the state.
  virtual bool settle(int k, double* y) const = 0;
  /// Called when a step was taken and no law changed at its end.
  virtual void step_taken() = 0;

  /// Changes to the law that follows guard k, or a time (-1). Returns whether the state jumped.
  virtual bool cross(int k, double t, double* y) = 0;

  /// Whether some law ends here.
  virtual bool is_over() const = 0;
  /// Whether nothing moves, now and for ever.
  virtual bool rests() const = 0;

  /// The current laws, and everything else that the next step depends on.
  virtual std::vector<double> saved_state() const = 0;
};

}  // namespace pendcore
