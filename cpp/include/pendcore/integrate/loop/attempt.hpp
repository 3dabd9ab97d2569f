/// \file
/// What comes of trying a step.
#pragma once

namespace pendcore {

struct Attempt {
  /// The mean over components of (err / (atol + rtol max(|y|, |y_new|)))^2: at most 1 where the
  /// step is within the tolerances, not finite where a stage was not.
  double squared_error;
  /// 2^gain err^-exponent, what the control makes of it (step_control.hpp).
  double factor;
  bool converged = true;  ///< the iteration of an implicit method
};

}  // namespace pendcore
