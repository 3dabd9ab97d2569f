/// \file
/// Whether the steps of an explicit method are limited by stability.
#pragma once

#include "integrate/loop/integrate.hpp"

namespace pendcore {

/// The accepted steps before the first look, and between two looks if no step is suspicious.
inline constexpr int first_stiffness_look = 100;
inline constexpr int stiffness_looks_every = 1000;

/// Applies Hairer's test to an attempted step of size h: after a hundred accepted steps, after
/// every thousandth step from there, and after each suspicious step. After fifteen hits without six
/// misses in a row between them, the problem is called stiff (Hairer and Wanner, IV.2); the
/// statistics and the stepper are told. The eigenvalue comes from two stages of a Runge-Kutta step,
/// or for a Taylor series from dominant_eigenvalue.hpp.
void test_stiffness(Stepper& stepper, double h, IntegratorState& integrator);

}  // namespace pendcore
