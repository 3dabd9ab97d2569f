/// \file
/// THE ROOT LOCATOR: where a function first turns negative in 0 < theta <= 1.
///
/// A polynomial is isolated in Bernstein's form: with coefficients b_i on an interval, no sign
/// change among them means no root, one means one root; halving the interval separates the rest, so
/// that two roots close together are both seen. Any other function is sampled.
///
/// Source: Lane and Riesenfeld, BIT 21 (1981) 112. Cost: 20 operations where there is no root.
#pragma once

#include <functional>

namespace pendcore {

/// The least theta in (0, 1] from which p(theta) = sum_k coefficients[k] theta^k is negative, to
/// the last bits; above 1 if there is none. What is called begins where the function is positive or
/// has just been zero: a value at 0 that is below 1e-13 of the other coefficients counts as zero,
/// and the polynomial turns negative where it does so next. Degree at most 15.
double first_negative(const double* coefficients, int degree);

/// The same of a function, from its values at `samples` points and a bisection between two.
double first_negative(const std::function<double(double)>& f, int samples);

}  // namespace pendcore
