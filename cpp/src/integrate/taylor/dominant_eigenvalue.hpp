/// \file
/// The rate of the fastest part of a direction v: with the Jacobian J of y' = f(t, y), y = (q, qd),
///
///     |lambda| = (|J J v| / |v|)^(1/2)      (1/s)
///
/// The high coefficients of a Taylor series are good directions: each is J times the coefficient
/// before, divided by its order, so that the fastest part outgrows the rest (power iteration). J is
/// applied twice because a pair of conjugate eigenvalues turns v in its plane: J J v = -omega^2 v
/// without damping.
///
/// J v is a central difference over a millionth of a radian, which is good enough for an estimate
/// of two digits. Cost: four right-hand sides.
#pragma once

#include <vector>

#include "integrate/stepper.hpp"

namespace pendcore {

/// The right-hand sides that stiffness_of_series() counts as.
inline constexpr int evaluations_of_stiffness = 4;

/// h |lambda| over the order of a series, for a step of size h from the state y at time t. The last
/// coefficient of the series there is the direction v, n angles and n rates; the quadratures that y
/// may have after these are left out of account. Returns 0 if v is zero or not finite.
double stiffness_of_series(const Rates& rates, double t, const std::vector<double>& y,
                           std::vector<double> v, double h, int order);

}  // namespace pendcore
