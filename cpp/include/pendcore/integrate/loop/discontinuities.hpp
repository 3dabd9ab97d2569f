/// \file
/// Where a right-hand side is not smooth, as the loop sees it: times that no step may cross, and
/// guards, functions of time and state that stay positive until the law changes.
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

  /// Chooses the laws for a start at time t; may adjust the state. Whether the state jumped.
  virtual bool begin(double t, double* y, bool forward) = 0;

  /// The next time after t, in the run's direction, that no step may cross; infinite if none.
  virtual double next_time(double t) const = 0;
  /// The longest step that cannot stride unseen over what sets a guard off: what drives a joint
  /// that is held does not show in the error of a step. Infinite where nothing does so.
  virtual double longest_step() const = 0;

  /// Guards are numbered from 0; the first `linear_guards()` of them are linear in the state.
  virtual int guards() const = 0;
  virtual int linear_guards() const = 0;
  /// How many of the guard, its slope, its curvature are zero where the next step begins, whatever
  /// rounding says.
  virtual int zeros_at_start(int k) const = 0;
  /// The coefficients of a linear guard along the dense output, a polynomial given by (degree + 1)
  /// rows of `dimension` numbers.
  virtual void polynomial(int k, const double* rows, int degree, int dimension,
                          double* coefficients) const = 0;
  virtual double guard(int k, const double* y) const = 0;
  /// The slope that a guard on a rate has where the joint is at rest, 1/s, though it be turning in
  /// the state given; NaN of any other guard. Errors of the rate have no part in it: a guard that
  /// would rise there cannot have fallen through zero.
  virtual double slope_at_rest(int k, double t, const double* y) = 0;
  /// How far a guard's value can be off by the rounding of the state.
  virtual double rounding(int k, const double* y) const = 0;
  /// The values of the others.
  virtual void other_guards(double t, const double* y, double* values) = 0;

  /// Whether settle() is wanted at the end of every step, not on guards alone.
  virtual bool settles_every_step() const = 0;
  /// Adjusts the state at a step's end: what holds exactly there, as a guard's zero (k, or -1 if
  /// the step ends at none). Whether something was changed.
  virtual bool settle(int k, double* y) const = 0;
  /// A step was taken, and no law changed at its end.
  virtual void step_taken() = 0;

  /// The law that follows on guard k, or on a time (-1). Whether the state jumped.
  virtual bool cross(int k, double t, double* y) = 0;

  /// Whether a law does not go on from here.
  virtual bool is_over() const = 0;
  /// Whether nothing moves, nor ever will.
  virtual bool rests() const = 0;

  /// Which laws are in force, and all else that the next step depends on.
  virtual std::vector<double> saved_state() const = 0;
};

}  // namespace pendcore
