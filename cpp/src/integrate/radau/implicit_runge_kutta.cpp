#include "pendcore/integrate/radau/implicit_runge_kutta.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pendcore/arithmetic/epsilon.hpp"
#include "pendcore/integrate/horner.hpp"
#include "pendcore/integrate/runge_kutta/compensation.hpp"

namespace pendcore {
namespace {

constexpr int most_iterations = 20;  // a fixed step may be long
constexpr int usual_iterations = 7;  // more than these make the next step shorter
constexpr double log2_smallest_error = -6.643856189774724;  // log2(1e-2)

/// x^p for x > 0, the same on every machine.
double small_power(double x, double p) { return approximate_exp2(p * approximate_log2(x)); }

}  // namespace

ImplicitRungeKutta::ImplicitRungeKutta(const Collocation& method,
                                       std::unique_ptr<DifferentiableSystem> system,
                                       bool compensated)
    : method_(method),
      system_(std::move(system)),
      n_(system_->row),
      state_(2 * n_),
      size_(state_ + system_->quadratures),
      rtol_(state_),
      atol_(state_),
      y_(size_),
      dydt_(size_),
      y_new_(size_),
      stages_(3 * static_cast<std::size_t>(size_)),
      transformed_(3 * static_cast<std::size_t>(state_)),
      rates_(stages_.size()),
      increment_(transformed_.size()),
      trial_(size_),
      error_(size_),
      slope_(size_),
      polynomial_(stages_.size()),
      low_(compensated ? size_ : 0),
      low_new_(low_.size()) {}

void ImplicitRungeKutta::set_tolerances(const double* rtol, const double* atol) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < state_; ++i) {
    const double given = std::max(rtol[i], epsilon);
    rtol_[i] = 0.1 * small_power(given, 2.0 / 3.0);
    atol_[i] = rtol_[i] * (atol[i] / given);
    smallest = std::min(smallest, rtol_[i]);
  }
  newton_tolerance_ = std::max(10.0 * epsilon / smallest, std::min(0.03, std::sqrt(smallest)));
}

void ImplicitRungeKutta::start(const double* y, const double* dydt) {
  // The systems are allocated only here, because a pair of methods may never need them.
  systems_.resize(n_);
  drop_changed(y, y_.data(), static_cast<int>(low_.size()), low_.data());
  std::copy_n(y, size_, y_.begin());
  std::copy_n(dydt, size_, dydt_.begin());
  has_jacobian_ = false;
  h_before_ = 0.0;
  contraction_ = 1.0;
  is_retry_ = false;
}
void ImplicitRungeKutta::get_state(double* y) const { std::ranges::copy(y_, y); }
void ImplicitRungeKutta::get_derivative(double* dydt) const { std::ranges::copy(dydt_, dydt); }
void ImplicitRungeKutta::get_new_state(double* y) const { std::ranges::copy(y_new_, y); }
void ImplicitRungeKutta::set_new_state(const double* y) {
  drop_changed(y, y_new_.data(), static_cast<int>(low_new_.size()), low_new_.data());
  std::copy_n(y, size_, y_new_.begin());
}
void ImplicitRungeKutta::evaluate(double t, const double* y, double* dydt) {
  (*system_)(t, y, dydt);
  ++evaluations;
}

double ImplicitRungeKutta::scale(int i) const {
  const double largest = std::max(std::abs(y_[i]), std::abs(y_new_[i]));
  return atol_[i] + rtol_[i] * largest + 1e-300;  // avoids 0/0
}
double ImplicitRungeKutta::squared_norm(const double* error) const {
  double sum = 0.0;
  for (int i = 0; i < state_; ++i) {
    const double ratio = error[i] / scale(i);
    sum += ratio * ratio;
  }
  return sum / state_;
}

/// Predicts the stages by continuing the polynomial of the step before: Z_i = u(1 + x) - u(1), x =
/// c_i h/h_before.
void ImplicitRungeKutta::predict(double h) {
  for (int k = 0; k < 3; ++k) {
    const double x = h_before_ == 0.0 ? 0.0 : method_.c[k] * (h / h_before_);
    const double square = x * (2.0 + x);
    const double cube = x * (3.0 + x * (3.0 + x));
    for (int i = 0; i < state_; ++i) {
      const double* const p = polynomial_.data() + i;
      stages_[k * size_ + i] =
          h_before_ == 0.0 ? 0.0 : x * p[0] + square * p[size_] + cube * p[2 * size_];
    }
  }
  for (int k = 0; k < 3; ++k) {
    const Collocation::Row& row = method_.inverse[k];
    for (int i = 0; i < state_; ++i) {
      transformed_[k * state_ + i] =
          row[0] * stages_[i] + row[1] * stages_[size_ + i] + row[2] * stages_[2 * size_ + i];
    }
  }
}

/// Whether the last increment is no larger than the rounding errors of rates and states.
bool ImplicitRungeKutta::is_rounding(double h) const {
  for (int i = 0; i < state_; ++i) {
    double size = std::abs(y_[i]) + std::abs(y_new_[i]);
    double increment = 0.0;
    for (int k = 0; k < 3; ++k) {
      size += std::abs(h * rates_[k * size_ + i]);
      increment = std::max(increment, std::abs(increment_[k * state_ + i]));
    }
    if (!(increment <= 16.0 * epsilon * size)) return false;
  }
  return true;
}

/// Solves for the stages by Newton's iteration. Returns false if it does not converge.
bool ImplicitRungeKutta::iterate(double t, double h) {
  double* const w = transformed_.data();
  double* const d = increment_.data();
  double factor = small_power(std::max(contraction_, epsilon), 0.8);  // theta/(1 - theta)
  contraction_of_attempt_ = contraction_;
  double before = 0.0;
  double ratio_before = 0.0;
  for (iterations_ = 1; iterations_ <= most_iterations; ++iterations_) {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < state_; ++i) trial_[i] = y_[i] + stages_[k * size_ + i];
      evaluate(t + method_.c[k] * h, trial_.data(), &rates_[static_cast<std::size_t>(k) * size_]);
    }
    const double real = systems_.real();
    const Complex g = systems_.complex();
    for (int i = 0; i < state_; ++i) {
      double rate[3];
      for (int k = 0; k < 3; ++k) {
        const Collocation::Row& row = method_.inverse[k];
        rate[k] = row[0] * rates_[i] + row[1] * rates_[size_ + i] + row[2] * rates_[2 * size_ + i];
      }
      const double re = w[state_ + i];
      const double im = w[2 * state_ + i];
      d[i] = rate[0] - real * w[i];
      d[state_ + i] = rate[1] - (g.re * re - g.im * im);
      d[2 * state_ + i] = rate[2] - (g.im * re + g.re * im);
    }
    systems_.solve_real(d);
    systems_.solve_complex(d + state_, d + 2 * state_);
    for (int k = 0; k < 3 * state_; ++k) w[k] += d[k];
    for (int k = 0; k < 3; ++k) {
      const Collocation::Row& row = method_.transformation[k];
      for (int i = 0; i < state_; ++i) {
        stages_[k * size_ + i] =
            row[0] * w[i] + row[1] * w[state_ + i] + row[2] * w[2 * state_ + i];
      }
    }
    for (int i = 0; i < state_; ++i) y_new_[i] = y_[i] + stages_[2 * size_ + i];

    const double size = std::sqrt(
        (squared_norm(d) + squared_norm(d + state_) + squared_norm(d + 2 * state_)) / 3.0);
    if (!std::isfinite(size)) return false;
    if (iterations_ > 1) {
      const double ratio = size / before;
      const double theta = iterations_ == 2 ? ratio : std::sqrt(ratio * ratio_before);
      ratio_before = ratio;
      if (!(theta < 0.99)) return size <= newton_tolerance_ || is_rounding(h);
      factor = theta / (1.0 - theta);
      double left = factor * size;
      for (int k = iterations_; k < most_iterations; ++k) left *= theta;
      if (left > newton_tolerance_) return is_rounding(h);
    }
    before = std::max(size, epsilon);
    if (factor * size <= newton_tolerance_) {
      contraction_of_attempt_ = factor;
      return true;
    }
  }
  return false;
}

/// Computes Z = h a q' for the angles from the rates that were found, which restores digits that
/// the transformation T costs. A rate that nothing changes, as in a held joint, keeps its last bit.
void ImplicitRungeKutta::polish(double h) {
  for (int i = n_; i < state_; ++i) {
    if (rates_[i] != 0.0 || rates_[size_ + i] != 0.0 || rates_[2 * size_ + i] != 0.0) continue;
    for (int k = 0; k < 3; ++k) stages_[k * size_ + i] = 0.0;
  }
  for (int k = 0; k < 3; ++k) {
    const Collocation::Row& row = method_.a[k];
    for (int i = 0; i < n_; ++i) {
      const double* const rate = &stages_[n_ + i];
      stages_[k * size_ + i] =
          h * (method_.c[k] * y_[n_ + i] +
               (row[0] * rate[0] + row[1] * rate[size_] + row[2] * rate[2 * size_]));
    }
  }
}

/// Computes y + Z_3, with the rounding error if the method is compensated.
void ImplicitRungeKutta::advance() {
  const double* const change = &stages_[2 * static_cast<std::size_t>(size_)];
  for (int i = 0; i < size_; ++i) {
    const double whole = low_.empty() ? change[i] : change[i] + low_[i];
    y_new_[i] = y_[i] + whole;
    if (!low_.empty()) low_new_[i] = left_over(y_[i], whole, y_new_[i]);
  }
}

/// Computes Z = h a P for the quadratures from their rates P at the stages that were found.
/// Quadratures take no part in the iteration and in the error.
void ImplicitRungeKutta::integrate_quadratures(double t, double h) {
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < state_; ++i) trial_[i] = y_[i] + stages_[k * size_ + i];
    evaluate(t + method_.c[k] * h, trial_.data(), &rates_[static_cast<std::size_t>(k) * size_]);
  }
  for (int i = state_; i < size_; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Collocation::Row& row = method_.a[k];
      stages_[k * size_ + i] =
          h * (row[0] * rates_[i] + row[1] * rates_[size_ + i] + row[2] * rates_[2 * size_ + i]);
    }
  }
}

Attempt ImplicitRungeKutta::attempt(const TwoDouble& time, double h, double /*gain*/) {
  const double t = time.high;
  if (!has_jacobian_) {
    system_->jacobian(t, y_.data(), systems_.by_q(), systems_.by_qd());
    has_jacobian_ = true;
  }
  h_ = h;
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  if (!systems_.factor(method_, h, keep_going)) return {{undefined, 0.0}};
  predict(h);
  const bool converges = iterate(t, h);  // if a user's function throws here, nothing was tried
  const bool is_careful = is_retry_ || h_before_ == 0.0;
  if (!is_retry_) ++jacobians;
  factorisations += 2;
  is_retry_ = true;
  if (!converges) return {{undefined, 0.0}, !std::isfinite(squared_norm(y_new_.data()))};
  polish(h);
  if (size_ > state_) integrate_quadratures(t, h);
  advance();

  auto filter = [&](const double* rate) {
    for (int i = 0; i < state_; ++i) error_[i] = rate[i] - power_of_stages(0, i) / h;
    systems_.solve_real(error_.data());
    return squared_norm(error_.data());
  };
  squared_error_ = filter(dydt_.data());
  set_slope(h);
  if (is_careful && squared_error_ >= 1.0) {
    // The error is filtered once more: a fast transient that is damped away is not an error.
    for (int i = 0; i < state_; ++i) trial_[i] = y_[i] + error_[i];
    evaluate(t, trial_.data(), rates_.data());
    squared_error_ = filter(rates_.data());
  }

  const double log2_error = 0.5 * approximate_log2(squared_error_);
  const double safety = 0.9 * (1 + 2 * usual_iterations) / (iterations_ + 2 * usual_iterations);
  double factor = approximate_exp2(approximate_log2(safety) - 0.25 * log2_error);
  if (h_before_ != 0.0) {
    const double log2_ratio = 0.25 * (log2_error_before_ - 2.0 * log2_error);
    factor = std::min(factor, 0.9 * (h / h_before_) * approximate_exp2(log2_ratio));
  }
  return {{squared_error_, factor}};
}

/// Sets h times the slope of the polynomial at its start. This is h f(t, y), so that sol(t) has no
/// corners, unless it differs from the slope of the stages by more than the error allows. Otherwise
/// a stiff component that has died out would turn the last bits of its state into a slope that the
/// motion does not have anywhere in the step.
void ImplicitRungeKutta::set_slope(double h) {
  bool all_are_exact = true;
  for (int i = 0; i < size_; ++i) {
    const double of_stages = power_of_stages(0, i);
    const double exact = h * dydt_[i];
    double filtered = 0.0;
    bool is_exact = all_are_exact;
    if (i < state_) {
      filtered = method_.real * error_[i];
      is_exact = std::abs(exact - of_stages) <= std::max(2.0 * std::abs(filtered), scale(i));
      all_are_exact = all_are_exact && is_exact;
    }
    slope_[i] = is_exact ? exact : of_stages + filtered;
  }
}

/// Nothing moves, so the length of the step does not matter. No system is solved: its matrix would
/// be infinite for a step of some 1e-300 s.
void ImplicitRungeKutta::stay() {
  y_new_ = y_;
  low_new_ = low_;
  std::ranges::fill(stages_, 0.0);
  std::ranges::fill(slope_, 0.0);
  squared_error_ = 0.0;
}

void ImplicitRungeKutta::write_polynomial(double* rows) const {
  for (int p = 0; p < 3; ++p) {
    for (int i = 0; i < size_; ++i) rows[p * size_ + i] = power_of_stages(p, i);
  }
}

void ImplicitRungeKutta::accept(double t_new) {
  write_polynomial(polynomial_.data());
  h_before_ = h_;
  log2_error_before_ = std::max(0.5 * approximate_log2(squared_error_), log2_smallest_error);
  contraction_ = contraction_of_attempt_;
  is_retry_ = false;
  has_jacobian_ = false;
  y_ = y_new_;
  low_ = low_new_;
  evaluate(t_new, y_.data(), dydt_.data());
}

void ImplicitRungeKutta::interpolant(double /*h*/, double* coefficients) {
  std::ranges::copy(y_, coefficients);
  double* const rows = coefficients + size_;
  write_polynomial(rows);
  for (int i = 0; i < size_; ++i) {
    const double change = slope_[i] - rows[i];
    rows[i] = slope_[i];
    for (int p = 1; p < Collocation::degree; ++p) {
      const double before = p < 3 ? rows[p * size_ + i] : 0.0;
      rows[p * size_ + i] = before + method_.correction[p] * change;
    }
  }
}

void ImplicitRungeKutta::sample(const double* coefficients, const TwoDouble& start, double h,
                                const double* times, int count, double* states) const {
  static const auto sample_on_this_processor = fastest<&sample_rows>();
  sample_on_this_processor(coefficients, start, h, times, count, states, size_,
                           Collocation::degree);
}

std::vector<double> ImplicitRungeKutta::saved_state() const {
  std::vector<double> memory = low_;
  memory.insert(memory.end(), polynomial_.begin(), polynomial_.end());
  memory.insert(memory.end(), {h_before_, log2_error_before_, contraction_, is_retry_ ? 1.0 : 0.0});
  return memory;
}
void ImplicitRungeKutta::restore(const std::vector<double>& memory) {
  if (memory.size() != polynomial_.size() + 4 + low_.size()) {
    throw std::invalid_argument(
        "what the method kept of its last step does not belong to this scene");
  }
  std::copy_n(memory.begin(), low_.size(), low_.begin());
  const double* const past = memory.data() + low_.size();
  std::copy_n(past, polynomial_.size(), polynomial_.begin());
  const double* const rest = past + polynomial_.size();
  h_before_ = rest[0];
  log2_error_before_ = rest[1];
  contraction_ = rest[2];
  is_retry_ = rest[3] != 0.0;
}

}  // namespace pendcore
