/// \file
/// The result of an attempted step.
#pragma once

namespace pendcore {

struct Attempt {
  /// The mean over components of (err / (atol + rtol max(|y|, |y_new|)))^2. It is at most 1 if the
  /// step is within the tolerances, and not finite if a stage was not.
  double squared_error;
  /// 2^gain err^-exponent, from which the control makes the next step size (step_control.hpp).
  double factor;
  bool converged = true;  ///< whether the iteration of an implicit method did
};

}  // namespace pendcore
