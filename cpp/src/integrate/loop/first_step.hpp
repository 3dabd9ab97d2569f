/// \file
/// A starting step from two right-hand sides.
///
/// Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.4, as in
/// the program DOPRI5: an Euler step of 1 % of |y|/|dydt| gives the second derivative, and h^order
/// max(|d2y|, |dydt|) = 0.01 in the norm of the tolerances.
#pragma once

#include "integrate/stepper.hpp"

namespace pendcore {

struct FirstStep {
  double h;         ///< s, positive
  bool is_bounded;  ///< the Euler step was cut to the time that is left
};

FirstStep first_step(Stepper& stepper, double t, double t_end, double max_step, const double* rtol,
                     const double* atol);

}  // namespace pendcore
