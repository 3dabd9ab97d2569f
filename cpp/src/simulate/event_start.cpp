// When the events of EventFinder are armed in a run that starts on one of them.
//
// The state that a run stored at an event is the dense output at the event's time, and a run may
// start there. So its start is off an event by the rounding of the state, of the polynomial and of
// time, each relative to the sizes of what is added up: radians for angles, for rates the rates of
// all links and those that the accelerations give them within a radian. The first step of the new
// run may be much shorter than the step on which the event lay, so it does not tell these sizes.
#include <algorithm>
#include <cmath>
#include <utility>

#include "arithmetic/epsilon.hpp"
#include "simulate/event_finder.hpp"

namespace pendcore {
namespace {

constexpr double share = 8.0 * last_bits_share;

/// rad/s
double natural_rate(const double* rows, int n, int dimension, double h) {
  double rate = 0.0;
  double acceleration = 0.0;
  for (int i = n; i < 2 * n; ++i) {
    rate = std::max(rate, std::abs(rows[i]));
    acceleration = std::max(acceleration, std::abs(rows[dimension + i] / h));
  }
  return rate + std::sqrt(acceleration);
}

}  // namespace

/// The value with which a step begins or a jump is entered: 0 if an event is not armed there.
double EventFinder::armed_value(std::size_t k, double value) const {
  return std::abs(value) <= unarmed_within_[k] ? 0.0 : value;
}

double EventFinder::rounding_at_start(const Difference& difference, const Step& step) const {
  const int dimension = step.output.dimension();
  double size = difference.plus < n_ ? 1.0 + std::abs(difference.value)
                                     : natural_rate(step.rows, n_, dimension, step.h);
  for (int p = 0; p <= step.output.interpolant_degree(); ++p) {
    const double* const row = step.rows + static_cast<std::ptrdiff_t>(p) * dimension;
    size += std::abs(row[difference.plus]);
    if (difference.minus >= 0) size += std::abs(row[difference.minus]);
  }
  return share * size;
}

/// The same for a TipLine or a Function with the value `start`. A Function is asked how much it
/// changes as each of its arguments goes on by its rounding; it may be undefined there. A run of a
/// few units in the last place of its time has events of time in each of them.
double EventFinder::rounding_at_start(std::size_t k, const Step& step, double start) {
  const double t = step.t_old.high;
  if (tip_line_of_[k] >= 0) return 8.0 * tip_lines_[tip_line_of_[k]].rounding(t, step.rows);
  const auto n = static_cast<std::size_t>(n_);
  const double* const moves = step.rows + step.output.dimension();
  const double rate = natural_rate(step.rows, n_, step.output.dimension(), step.h);
  std::copy_n(step.rows, 2 * n, y_.begin());
  double sum = 0.0;
  double time = t;
  const auto& function = std::get<events::Function>(events_[k].function);
  const auto change_to = [&](double& argument, double there) {
    const double before = std::exchange(argument, there);
    const double value = function.f(time, std::span(y_.data(), n), std::span(y_.data() + n, n));
    argument = before;
    return std::isnan(value) ? 0.0 : std::abs(value - start);
  };
  const double moment =
      std::min(share * (std::abs(t) + std::abs(step.h)), 0x1p-12 * std::abs(step.h));
  sum += change_to(time, t + std::copysign(moment, step.h));
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const double size = i < n ? 1.0 + std::abs(y_[i]) : rate;
    sum += change_to(y_[i], y_[i] + std::copysign(share * size, moves[i]));
  }
  return sum;
}

}  // namespace pendcore
