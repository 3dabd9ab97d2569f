#include "pendcore/integrate/stepper.hpp"

#include <algorithm>
#include <cmath>

namespace pendcore {

void Stepper::finite_interpolant(double h, double* coefficients) {
  interpolant(h, coefficients);
  // A stage that overflows enters the highest coefficient as well, and so does a term of a series
  // in the terms after it: to look there is enough.
  const auto size = static_cast<std::ptrdiff_t>(dimension());
  const std::ptrdiff_t all = (interpolant_degree() + 1) * size;
  const bool is_finite = std::all_of(coefficients + all - size, coefficients + all,
                                     [](double x) { return std::isfinite(x); });
  if (is_finite) return;
  double* const slope = coefficients + size;
  get_state(coefficients);
  get_new_state(slope);
  for (std::ptrdiff_t i = 0; i < size; ++i) slope[i] -= coefficients[i];
  std::fill(slope + size, coefficients + all, 0.0);
}

}  // namespace pendcore
