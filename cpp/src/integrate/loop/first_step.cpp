#include "integrate/loop/first_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "arithmetic/power.hpp"

namespace pendcore {

FirstStep first_step(Stepper& stepper, double t, double t_end, double max_step, const double* rtol,
                     const double* atol) {
  if (const double own = stepper.own_first_step(t); own > 0.0) {
    return {std::min(own, max_step), false};
  }
  const int n = stepper.controlled();
  const int size = stepper.dimension();
  // A run of a few links asks the heap for nothing here.
  constexpr int few = 8;
  std::array<double, static_cast<std::size_t>(5 * few)> of_few;
  std::vector<double> of_many(size > few ? 5 * size : 0);
  double* const y = size > few ? of_many.data() : of_few.data();
  double* const rate = y + size;
  double* const euler = rate + size;
  double* const euler_rate = euler + size;
  double* const scale = euler_rate + size;
  stepper.get_state(y);
  stepper.get_derivative(rate);

  double rate_squares = 0.0;
  double state_squares = 0.0;
  for (int i = 0; i < n; ++i) {
    scale[i] = atol[i] + rtol[i] * std::abs(y[i]);
    rate_squares += (rate[i] / scale[i]) * (rate[i] / scale[i]);
    state_squares += (y[i] / scale[i]) * (y[i] / scale[i]);
  }
  double h = rate_squares <= 1e-10 || state_squares <= 1e-10 || !std::isfinite(rate_squares)
                 ? 1e-6
                 : 0.01 * std::sqrt(state_squares / rate_squares);
  h = std::min(h, max_step);
  const double direction = t_end < t ? -1.0 : 1.0;
  const double left = std::abs(t_end - t);
  const bool is_bounded = h > left;
  h = std::min(h, left);

  for (int i = 0; i < n; ++i) euler[i] = y[i] + direction * h * rate[i];
  stepper.evaluate(is_bounded ? t_end : t + direction * h, euler, euler_rate);
  double change_squares = 0.0;
  for (int i = 0; i < n; ++i) {
    const double change = (euler_rate[i] - rate[i]) / scale[i];
    change_squares += change * change;
  }
  const double second = std::sqrt(change_squares) / h;
  const double steepest = std::max(second, std::sqrt(rate_squares));
  double by_order;
  if (!std::isfinite(steepest)) {
    by_order = 1e-3 * h;
  } else if (steepest <= 1e-15) {
    by_order = std::max(1e-6, 1e-3 * h);
  } else {
    by_order = approximate_exp2(approximate_log2(0.01 / steepest) / stepper.info().order);
  }
  return {std::min({100.0 * h, by_order, max_step}), is_bounded};
}

}  // namespace pendcore
