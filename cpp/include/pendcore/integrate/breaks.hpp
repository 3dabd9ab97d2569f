/// \file
/// Where a right-hand side is not smooth, as the loop sees it: times that no step may cross, and
/// guards, functions of time and state that stay positive until the law changes.
///
/// While a step is taken the law is frozen, so that method and error estimate see a smooth
/// function. The loop cuts the step that would make a guard negative at the guard's zero, redoes it
/// to the last bits of that time, and asks for the law that follows.
#pragma once

#include <vector>

#include "pendcore/integrate/status.hpp"

namespace pendcore {

class Breaks {
 public:
  virtual ~Breaks() = default;

  /// Chooses the laws for a start at time t; may adjust the state. Status::finished: go on.
  virtual Status begin(double t, double* y, bool forward) = 0;

  /// The next time after t, in the run's direction, that no step may cross; infinite if none.
  virtual double next_time(double t) const = 0;

  virtual int guards() const = 0;
  virtual double guard(int k, const double* y) const = 0;
  /// A guard is linear in the state, and so a polynomial along the dense output, (degree + 1) rows
  /// of `dimension` numbers: its coefficients.
  virtual void polynomial(int k, const double* rows, int degree, int dimension,
                          double* coefficients) const = 0;

  /// Whether settle() is wanted at the end of every step, not on guards alone.
  virtual bool settles_every_step() const = 0;
  /// Adjusts the state at a step's end: what holds exactly there, as a guard's zero (k, or -1 if
  /// the step ends at none). Whether something was changed.
  virtual bool settle(int k, double* y) const = 0;

  /// The law that follows on guard k, or on a time (-1). Status::finished: go on.
  virtual Status cross(int k, double t, const double* y) = 0;

  /// Which laws are in force, and all else that the next step depends on.
  virtual std::vector<double> memory() const = 0;
};

}  // namespace pendcore
