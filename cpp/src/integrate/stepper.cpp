#include "pendcore/integrate/stepper.hpp"

#include <algorithm>
#include <cmath>

namespace pendcore {

namespace {

/// Puts a straight line in the place of an interpolant that overflows.
void straighten(Stepper& stepper, double* coefficients) {
  const auto size = static_cast<std::ptrdiff_t>(stepper.dimension());
  const std::ptrdiff_t degree = stepper.interpolant_degree();
  const double* const highest = coefficients + degree * size;
  auto overflows = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    return !std::all_of(highest + first, highest + last, [](double x) { return std::isfinite(x); });
  };
  // The motion does not depend on whether quadratures are integrated with it.
  const std::ptrdiff_t motion = stepper.controlled();
  const std::ptrdiff_t first = overflows(0, motion) ? 0 : motion;
  const std::ptrdiff_t last = overflows(motion, size) ? size : motion;
  if (first >= last) return;
  std::vector<double> y(size);
  std::vector<double> y_new(size);
  stepper.get_state(y.data());
  stepper.get_new_state(y_new.data());
  for (std::ptrdiff_t i = first; i < last; ++i) {
    coefficients[i] = y[i];
    coefficients[size + i] = y_new[i] - y[i];
    for (std::ptrdiff_t p = 2; p <= degree; ++p) coefficients[p * size + i] = 0.0;
  }
}

}  // namespace

void Stepper::finite_interpolant(double h, double* coefficients) {
  interpolant(h, coefficients);
  const auto size = static_cast<std::ptrdiff_t>(dimension());
  // An overflow in a stage, or in a term of a series, shows in the highest coefficient as well:
  // only that one is looked at.
  const double* const highest = coefficients + interpolant_degree() * size;
  double zero = 0.0;
  for (std::ptrdiff_t i = 0; i < size; ++i) zero += 0.0 * highest[i];  // NaN, unless all are finite
  if (zero != 0.0) straighten(*this, coefficients);
}

}  // namespace pendcore
