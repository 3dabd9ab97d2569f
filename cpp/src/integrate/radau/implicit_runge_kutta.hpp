/// \file
/// A collocation method as the loop sees it; collocation_step.hpp has the step itself.
#pragma once

#include <memory>

#include "integrate/general_system.hpp"
#include "integrate/radau/collocation.hpp"
#include "integrate/stepper.hpp"

namespace pendcore {

/// The stepper of an implicit method. If its iteration does not converge, the error of an attempt
/// is NaN, so that the step is not accepted. One or two links without quadratures have kernels of
/// their own, with the same bits.
std::unique_ptr<Stepper> implicit_runge_kutta(const Collocation& method,
                                              std::unique_ptr<DifferentiableSystem> system,
                                              bool compensated = false);

}  // namespace pendcore
