/// \file
/// Finds where along an attempted step the law changes: the guards of Discontinuities, evaluated on
/// the dense output.
///
/// A guard that is linear in the state is a polynomial there. Any other is taken at nine points of
/// the step (Chebyshev's) and interpolated; where it is zero is then found from its own values.
#pragma once

#include <array>
#include <vector>

#include "pendcore/integrate/loop/discontinuities.hpp"
#include "pendcore/integrate/stepper.hpp"

namespace pendcore {

/// The first guard that the attempted step would make negative, and where in the step; none: -1.
struct Crossing {
  int guard = -1;
  double theta = 2.0;
  /// The guard had fallen below zero by an error, and its slope follows there: what a rate is that
  /// is lost in errors, the torques on the joint still tell.
  bool is_of_slope = false;
};

class Guards {
 public:
  Guards(Stepper& stepper, Discontinuities& discontinuities);

  /// In the attempted step of size h from time t. The dense output of a few last bits of time says
  /// nothing of what sets out from rest: not `from_rest_too`.
  Crossing first(double t, double h, bool from_rest_too = true);

  /// Whether a guard that the dense output makes negative where the step begins is so: one that is
  /// positive there, or rises from zero, is not. Where that is not known, a step that was halved
  /// ten times is believed.
  bool falls_at_start(int k, double t, double h, int halvings);

  /// Whether a guard that begins at zero is made negative by the error of the dense output: before
  /// the crossing, more than by rounding, or at the crossing itself.
  bool contradicts_law_at_start(const Crossing& crossing, double h);

  /// The attempted step that ends where the guard is zero, to the last bits of time.
  struct Located {
    bool is_found;
    double h;
    Attempt attempt;
  };
  /// Redoes the step of size `whole` for it: the state there comes from the method, not from the
  /// interpolant. `gain` is the control's; `last_bits` are those of time.
  Located locate(const Crossing& crossing, double t, double whole, double gain, double last_bits);

 private:
  /// By how much the step's end misses the zero of a guard, and how much of that may be rounding,
  /// in units of the step.
  struct Miss {
    double share, rounding;
  };
  Miss miss(const Crossing& crossing, double t, double h);
  int along_step(int k);
  std::array<double, 3> start_of(int k);
  void sample(double theta);
  void slopes_along_step(int k, double t, double h, double from);
  Crossing where_slope_allows(Crossing crossing, double t, double h, int degree);
  Miss miss_of_slope(int k, double t, double h);
  bool is_of_error(const Crossing& crossing, double h);
  bool goes_below(double theta);
  double rise_at_start(int k, double h);
  bool rises_from_rest(int k);
  double value_at(int k, double t);
  void interpolate_others(double t, double h);

  Stepper& stepper_;
  Discontinuities& discontinuities_;
  int dimension_;
  int degree_;
  std::vector<double> rows_;  ///< the dense output of the step
  std::vector<double> state_;
  std::vector<double> polynomial_;  ///< of a guard, in theta
  std::vector<double> slopes_;      ///< of a guard on a rate, were the joint at rest; in theta
  std::vector<double> samples_;     ///< (points, others), and then the same as polynomials
};

}  // namespace pendcore
