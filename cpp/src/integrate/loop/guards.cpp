#include "integrate/loop/guards.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "arithmetic/epsilon.hpp"
#include "integrate/events/root.hpp"
#include "integrate/horner.hpp"

namespace pendcore {
namespace {

constexpr int points = 9;
/// If slope and curvature of a guard do not say whether it falls at the start of a step, the dense
/// output is believed after so many halvings of the step.
constexpr int halvings_without_sign = 20;
/// After so many halvings it is believed in any case.
constexpr int most_halvings = 50;
/// How often the share of a step is halved in the search for an error of the dense output.
constexpr int shares = 30;

/// sin^2(i pi / 16)
constexpr std::array<double, points> nodes = {
    0.0, 0.03806023374435663, 0.14644660940672624, 0.30865828381745514,
    0.5, 0.6913417161825449,  0.8535533905932737,  0.9619397662556434,
    1.0};

/// Replaces values at the nodes by the coefficients, in powers of theta, of the polynomial through
/// them, by way of Newton's divided differences. Values and coefficients are `stride` apart.
void interpolate(double* values, int stride) {
  for (int order = 1; order < points; ++order) {
    for (int i = points - 1; i >= order; --i) {
      values[i * stride] =
          (values[i * stride] - values[(i - 1) * stride]) / (nodes[i] - nodes[i - order]);
    }
  }
  for (int i = points - 2; i >= 0; --i) {
    for (int k = i; k < points - 1; ++k) values[k * stride] -= nodes[i] * values[(k + 1) * stride];
  }
}

double slope_at_end(const double* coefficients, int degree) {
  double slope = 0.0;
  for (int p = degree; p > 0; --p) slope += p * coefficients[p];
  return slope;
}

/// The polynomial between theta and 1, as a function of the share of that part.
std::vector<double> beyond(const double* coefficients, int degree, double theta) {
  std::vector<double> rest(coefficients, coefficients + degree + 1);
  for (int from = 0; from < degree; ++from) {
    for (int p = degree - 1; p >= from; --p) rest[p] += theta * rest[p + 1];
  }
  double power = 1.0;
  for (double& one : rest) {
    one *= power;
    power *= 1.0 - theta;
  }
  return rest;
}

}  // namespace

Guards::Guards(Stepper& stepper, Discontinuities& discontinuities)
    : stepper_(stepper),
      discontinuities_(discontinuities),
      dimension_(stepper.dimension()),
      degree_(stepper.interpolant_degree()),
      rows_(static_cast<std::size_t>(degree_ + 1) * dimension_),
      state_(dimension_),
      polynomial_(static_cast<std::size_t>(std::max(degree_ + 1, points))),
      slopes_(points) {}

/// Sets polynomial_ to guard k in theta, and returns its degree. A guard that is not linear has
/// been interpolated.
int Guards::along_step(int k) {
  const int other = k - discontinuities_.linear_guards();
  if (other < 0) {
    discontinuities_.polynomial(k, rows_.data(), degree_, dimension_, polynomial_.data());
    const int zeros = discontinuities_.multiplicity_at_start(k);
    for (int p = 0; p < zeros; ++p) polynomial_[p] = 0.0;
    return degree_;
  }
  const int others = discontinuities_.guards() - discontinuities_.linear_guards();
  for (int p = 0; p < points; ++p) polynomial_[p] = samples_[p * others + other];
  return points - 1;
}

/// Sets state_ to the dense output at theta.
void Guards::sample(double theta) {
  for (int c = 0; c < dimension_; ++c) {
    state_[c] = horner<double>(&rows_[c], degree_, dimension_, theta);
  }
}

/// Sets samples_ to a polynomial for each guard that is not linear.
void Guards::interpolate_others(double t, double h) {
  const int others = discontinuities_.guards() - discontinuities_.linear_guards();
  samples_.resize(static_cast<std::size_t>(points) * others);
  for (int i = 0; i < points; ++i) {
    sample(nodes[i]);
    discontinuities_.other_guards(t + nodes[i] * h, state_.data(),
                                  samples_.data() + static_cast<std::ptrdiff_t>(i) * others);
  }
  for (int k = 0; k < others; ++k) interpolate(samples_.data() + k, others);
}

Crossing Guards::first(double t, double h, bool from_rest_too) {
  Crossing found;
  const int guards = discontinuities_.guards();
  if (guards == 0) return found;
  stepper_.interpolant(h, rows_.data());
  if (guards > discontinuities_.linear_guards()) interpolate_others(t, h);
  for (int k = 0; k < guards; ++k) {
    const int degree = along_step(k);
    // Where the load jumps, the torque that holds a joint may be beyond its limit at once.
    const bool is_broken = k >= discontinuities_.linear_guards() &&
                           polynomial_[0] < -discontinuities_.rounding(k, state_.data());
    const double theta = is_broken ? 0.0 : first_negative(polynomial_.data(), degree);
    if (!(theta < found.theta) || (!from_rest_too && rises_from_rest(k))) continue;
    const Crossing crossing = where_slope_allows({k, theta}, t, h, degree);
    if (crossing.theta < found.theta) found = crossing;
  }
  return found;
}

/// Sets slopes_ to the polynomial of the slope at rest between `from` and the end of the step, as a
/// function of the share of that part.
void Guards::slopes_along_step(int k, double t, double h, double from) {
  const double direction = std::copysign(1.0, h);
  for (int i = 0; i < points; ++i) {
    const double theta = from + nodes[i] * (1.0 - from);
    sample(theta);
    slopes_[i] = direction * discontinuities_.slope_at_rest(k, t + theta * h, state_.data());
  }
  interpolate(slopes_.data(), 1);
}

/// A rate that a strong damper has made small is lost in the errors of a step, and so is its sign.
/// Returns the first crossing of polynomial_ that is not such an error, or where the slope at rest
/// makes the guard fall.
Crossing Guards::where_slope_allows(Crossing crossing, double t, double h, int degree) {
  const int k = crossing.guard;
  const bool was_released = discontinuities_.multiplicity_at_start(k) > 1;
  for (int dips = 0; dips < points; ++dips) {
    const double theta = crossing.theta;
    const bool at_start = theta * std::abs(h) <= last_bits_share * std::abs(t);
    if (!(was_released && at_start)) {  // the usual case
      sample(theta);
      const double slope = discontinuities_.slope_at_rest(k, t + theta * h, state_.data());
      if (!(slope * h > 0.0)) return crossing;
    }
    const double from = at_start ? 0.0 : theta;
    slopes_along_step(k, t, h, from);
    if (std::isnan(slopes_[0])) return crossing;
    if (was_released && at_start) slopes_[0] = 0.0;
    const double share = first_negative(slopes_.data(), points - 1);
    if (share > 1.0) return {};
    const double turns = from + share * (1.0 - from);
    double dip = 0.0;  // the depth to which the errors reach
    for (const double node : nodes) {
      dip = std::min(dip, polynomial_at(polynomial_.data(), degree, from + node * (turns - from)));
    }
    if (polynomial_at(polynomial_.data(), degree, turns) <= -dip) return {k, turns, true};
    // The guard has risen above the errors, so its next zero is real.
    const std::vector<double> rest = beyond(polynomial_.data(), degree, turns);
    const double next = first_negative(rest.data(), degree);
    if (next > 1.0) return {};
    crossing.theta = turns + next * (1.0 - turns);
  }
  return crossing;
}

double Guards::value_at(int k, double t) {
  const int other = k - discontinuities_.linear_guards();
  if (other < 0) return discontinuities_.guard(k, state_.data());
  samples_.resize(static_cast<std::size_t>(points) *
                  (discontinuities_.guards() - discontinuities_.linear_guards()));
  discontinuities_.other_guards(t, state_.data(), samples_.data());
  return samples_[other];
}

/// How a linear guard starts the step by the law. The curvature of a guard on a rate is not known:
/// it is 0.
Guards::Start Guards::start_of(int k) {
  const int n = stepper_.controlled() / 2;
  std::vector<double> rows(3 * static_cast<std::size_t>(dimension_), 0.0);
  double* const rates = &rows[dimension_];
  stepper_.get_derivative(rates);
  for (int i = 0; i < n; ++i) rates[dimension_ + i] = 0.5 * rates[n + i];
  std::array<double, 3> along{};
  discontinuities_.polynomial(k, rows.data(), 2, dimension_, along.data());
  return {.slope = along[1], .curvature = along[2]};
}

/// How a guard that begins at zero rises: its slope from the law or, where that is zero too, its
/// curvature; 0 where neither is known.
double Guards::rise_at_start(int k, double h) {
  const Start start = start_of(k);
  const int zeros = discontinuities_.multiplicity_at_start(k);
  const double rise = start.slope * h;
  if (zeros == 1 && rise != 0.0) return rise;
  return zeros <= 2 ? start.curvature : 0.0;
}

/// Whether guard k belongs to a joint that rests on its stop and is pushed away from it.
bool Guards::rises_from_rest(int k) {
  if (discontinuities_.multiplicity_at_start(k) == 0) return false;
  const Start start = start_of(k);
  return start.slope == 0.0 && start.curvature > 0.0;
}

/// Whether a linear guard is zero at the start of the step, apart from the last bits of its value
/// and of time, and the law makes it rise.
bool Guards::leaves_its_zero(int k, double t, double h, double value, double rounding) {
  if (k >= discontinuities_.linear_guards()) return false;
  const double slope = start_of(k).slope;
  const double missed = std::abs(slope) * last_bits_share * std::max(std::abs(t), std::abs(h));
  return slope * h > 0.0 && value >= -(rounding + missed);
}

bool Guards::falls_at_start(int k, double t, double h, int halvings) {
  if (halvings == most_halvings) return true;
  stepper_.get_state(state_.data());
  if (discontinuities_.multiplicity_at_start(k) == 0) {
    const double value = value_at(k, t);  // comes first, because rounding() uses it
    const double rounding = discontinuities_.rounding(k, state_.data());
    return value <= rounding && !leaves_its_zero(k, t, h, value, rounding);
  }
  const double rise = rise_at_start(k, h);
  return rise != 0.0 ? rise < 0.0 : halvings == halvings_without_sign;
}

bool Guards::contradicts_law_at_start(const Crossing& crossing, double h) {
  return is_of_error(crossing, h) || goes_below(crossing.theta);
}

/// Whether the guard, with the slope and the curvature that the law gives, reaches zero only after
/// twice the crossing's share of the step. Then the crossing is an error of the dense output.
bool Guards::is_of_error(const Crossing& crossing, double h) {
  const int k = crossing.guard;
  if (k < 0 || discontinuities_.multiplicity_at_start(k) == 0) return false;
  const int degree = along_step(k);
  const Start start = start_of(k);
  const int zeros = discontinuities_.multiplicity_at_start(k);
  if (zeros < 2) polynomial_[1] = start.slope * h;
  if (zeros < 3 && start.curvature != 0.0) polynomial_[2] = start.curvature * h * h;
  return first_negative(polynomial_.data(), degree) > 2.0 * crossing.theta;
}

bool Guards::goes_below(double theta) {
  const int linear = discontinuities_.linear_guards();
  for (int k = 0; k < linear; ++k) {
    if (discontinuities_.multiplicity_at_start(k) < 3) continue;
    stepper_.get_state(state_.data());
    discontinuities_.polynomial(k, rows_.data(), degree_, dimension_, polynomial_.data());
    polynomial_[0] = polynomial_[1] = 0.0;
    const double least = -discontinuities_.rounding(k, state_.data());
    double x = std::min(theta, 2.0);
    for (int halvings = 0; halvings < shares; ++halvings) {
      x *= 0.5;
      if (polynomial_at(polynomial_.data(), degree_, x) < least) return true;
    }
  }
  return false;
}

Guards::Miss Guards::miss_of_slope(int k, double t, double h) {
  slopes_along_step(k, t, h, 0.0);
  const double slope = slope_at_end(slopes_.data(), points - 1);
  if (slope == 0.0) return {0.0, 0.0};
  stepper_.get_new_state(state_.data());
  const double direction = std::copysign(1.0, h);
  return {direction * discontinuities_.slope_at_rest(k, t + h, state_.data()) / slope, 0.0};
}

Guards::Miss Guards::miss(const Crossing& crossing, double t, double h) {
  const int k = crossing.guard;
  stepper_.interpolant(h, rows_.data());
  if (crossing.is_of_slope) return miss_of_slope(k, t, h);
  const int other = k - discontinuities_.linear_guards();
  if (other >= 0) interpolate_others(t, h);
  const int degree = along_step(k);
  const double slope = slope_at_end(polynomial_.data(), degree);
  if (slope == 0.0) return {0.0, 0.0};
  double g = 0.0;
  if (discontinuities_.multiplicity_at_start(k) > 0) {
    // The growth since the start of the step, without the rounding of the state itself.
    for (int p = degree; p > 0; --p) g += polynomial_[p];
    return {g / slope, 0.0};
  }
  stepper_.get_new_state(state_.data());
  g = value_at(k, t + h);
  return {g / slope, discontinuities_.rounding(k, state_.data()) / std::abs(slope)};
}

Guards::Located Guards::locate(const Crossing& crossing, double t, double whole, double gain,
                               double last_bits) {
  double h = crossing.theta * whole;
  double before = std::numeric_limits<double>::infinity();
  Attempt attempt{};
  for (int polish = 0; polish < 10; ++polish) {
    attempt = stepper_.attempt({t}, h, gain);
    const Miss miss = this->miss(crossing, t, h);
    const double correction = miss.share * h;
    const double size = std::abs(correction);
    if (!(size <= 0.5 * std::abs(h))) break;
    const bool is_found = size <= last_bits_share * std::max(std::abs(t), std::abs(h)) ||
                          // The guard's own rounding can be larger, where it crosses zero slowly.
                          size <= miss.rounding * std::abs(h) ||
                          (size <= 1e-6 * std::abs(h) && size >= 0.5 * before);
    if (is_found) return {true, h, attempt};
    before = size;
    h -= correction;
    if (std::abs(h) > std::abs(whole)) {
      if (std::abs(h) > std::abs(whole) + last_bits) break;
      h = whole;
    }
  }
  return {false, h, attempt};
}

}  // namespace pendcore
