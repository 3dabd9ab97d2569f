#include "integrate/step_output.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "integrate/horner.hpp"

namespace pendcore {

void StepOutput::straighten(double* coefficients) {
  const auto size = static_cast<std::ptrdiff_t>(dimension());
  const std::ptrdiff_t degree = interpolant_degree();
  const double* const highest = coefficients + degree * size;
  auto overflows = [&](std::ptrdiff_t first, std::ptrdiff_t last) {
    return !std::all_of(highest + first, highest + last, [](double x) { return std::isfinite(x); });
  };
  // The motion does not depend on whether quadratures are integrated with it.
  const std::ptrdiff_t motion = controlled();
  const std::ptrdiff_t first = overflows(0, motion) ? 0 : motion;
  const std::ptrdiff_t last = overflows(motion, size) ? size : motion;
  if (first >= last) return;
  std::vector<double> y(size);
  std::vector<double> y_new(size);
  get_state(y.data());
  get_new_state(y_new.data());
  for (std::ptrdiff_t i = first; i < last; ++i) {
    coefficients[i] = y[i];
    coefficients[size + i] = y_new[i] - y[i];
    for (std::ptrdiff_t p = 2; p <= degree; ++p) coefficients[p * size + i] = 0.0;
  }
}

void StepOutput::sample(const double* coefficients, const TwoDouble& start, double h,
                        const double* times, int count, double* states) const {
  on_this_processor<&sample_rows>(coefficients, start, h, times, count, states, dimension(),
                                  interpolant_degree());
}

}  // namespace pendcore
