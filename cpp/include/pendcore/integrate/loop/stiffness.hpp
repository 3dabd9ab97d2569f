/// \file
/// Whether the steps of an explicit method are limited by stability.
#pragma once

#include "pendcore/integrate/loop/integrate.hpp"

namespace pendcore {

/// Hairer's test, of an attempted step of size h: after a hundred accepted steps, every thousandth
/// from there, and after each suspicious one. Fifteen hits, not interrupted by six misses, and the
/// problem is called stiff (Hairer and Wanner, IV.2): the statistics, and the stepper, are told.
/// The eigenvalue is that of two stages of a Runge-Kutta step; of a Taylor series, of
/// dominant_eigenvalue.hpp.
void test_stiffness(Stepper& stepper, double h, IntegratorState& integrator);

}  // namespace pendcore
