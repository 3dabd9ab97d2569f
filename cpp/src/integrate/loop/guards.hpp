/// \file
/// Finds where along an attempted step the law changes: the guards of Discontinuities, evaluated on
/// the dense output.
///
/// A guard that is linear in the state is a polynomial there. Any other guard is sampled at nine
/// Chebyshev points of the step and interpolated; its zero is then located by its own values.
#pragma once

#include <vector>

#include "integrate/loop/discontinuities.hpp"
#include "integrate/stepper.hpp"

namespace pendcore {

/// The first guard that the attempted step would make negative, and where in the step. If there is
/// none, `guard` is -1.
struct Crossing {
  int guard = -1;
  double theta = 2.0;
  /// Whether the guard fell below zero only by an error, and the crossing is where its slope
  /// becomes negative. Where errors hide a rate, the torques on the joint still give its slope.
  bool is_of_slope = false;
};

class Guards {
 public:
  Guards(Stepper& stepper, Discontinuities& discontinuities);

  /// Finds the crossing in the attempted step of size h from time t. Over a few last bits of time,
  /// the dense output does not show how a guard leaves zero from rest; such a step is asked without
  /// `from_rest_too`.
  Crossing first(double t, double h, bool from_rest_too);

  /// Whether a guard that the dense output makes negative at the start of the step does fall there.
  /// A guard that is positive there, or rises from zero, does not. Where this is not known, the
  /// dense output is believed after `halvings_without_sign` halvings of the step (guards.cpp).
  bool falls_at_start(int k, double t, double h, int halvings);

  /// Whether the error of the dense output makes a guard that begins at zero negative: at the
  /// crossing itself, or before it by more than rounding.
  bool contradicts_law_at_start(const Crossing& crossing, double h);

  /// The attempted step that ends where the guard is zero, to the last bits of time.
  struct Located {
    bool is_found;
    double h;
    Attempt attempt;
  };
  /// Attempts the step of size `whole` again so that it ends there: the state at its end comes from
  /// the method, not from the interpolant. `gain` is the one of the step control; `last_bits` are
  /// those of time.
  Located locate(const Crossing& crossing, double t, double whole, double gain, double last_bits);

 private:
  /// By how much the step's end misses the zero of a guard, and how much of that may be rounding,
  /// in units of the step.
  struct Miss {
    double share, rounding;
  };
  Miss miss(const Crossing& crossing, double t, double h);
  /// How a linear guard changes where the step starts.
  struct Start {
    double slope;      ///< 1/s
    double curvature;  ///< half the second derivative, 1/s^2
  };
  int along_step(int k);
  Start start_of(int k);
  void sample(double theta);
  void slopes_along_step(int k, double t, double h, double from);
  Crossing where_slope_allows(Crossing crossing, double t, double h, int degree);
  Miss miss_of_slope(int k, double t, double h);
  bool is_of_error(const Crossing& crossing, double h);
  bool goes_below(double theta);
  double rise_at_start(int k, double h);
  bool rises_from_rest(int k);
  bool leaves_its_zero(int k, double t, double h, double value, double rounding);
  double value_at(int k, double t);
  void interpolate_others(double t, double h);

  Stepper& stepper_;
  Discontinuities& discontinuities_;
  int dimension_;
  int degree_;
  std::vector<double> rows_;  ///< the dense output of the step
  std::vector<double> state_;
  std::vector<double> polynomial_;  ///< a guard as a polynomial in theta
  std::vector<double> slopes_;      ///< a guard's slope if the joint were at rest, in theta
  std::vector<double> samples_;     ///< (points, others): values, then coefficients
};

}  // namespace pendcore
