/// \file
/// The result of an attempted step.
#pragma once

namespace pendcore {

/// What an attempt is judged by. `Real` is a double, or a pack with a number of each of several
/// trajectories.
template <class Real>
struct ErrorAndFactor {
  /// The mean over components of (err / (atol + rtol max(|y|, |y_new|)))^2. It is at most 1 if the
  /// step is within the tolerances, and not finite if a stage was not.
  Real squared_error;
  /// 2^gain err^-exponent, from which the control makes the next step size (step_control.hpp).
  Real factor;
};

struct Attempt : ErrorAndFactor<double> {
  bool converged = true;  ///< whether the iteration of an implicit method did
};

}  // namespace pendcore
