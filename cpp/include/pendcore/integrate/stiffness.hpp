/// \file
/// Whether the steps of an explicit method are limited by stability.
#pragma once

#include "pendcore/integrate/integrate.hpp"

namespace pendcore {

/// Hairer's test, of an attempted step of size h: every thousandth accepted step and after each
/// suspicious one. Fifteen hits, not interrupted by six misses, and the problem is called stiff
/// (Hairer and Wanner, IV.2): the statistics, and the stepper, are told.
void test_stiffness(Stepper& stepper, double h, Position& position);

}  // namespace pendcore
