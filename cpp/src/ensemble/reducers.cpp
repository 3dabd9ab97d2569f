#include "ensemble/reducers.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "pendcore/mechanics.hpp"

namespace pendcore {

void Extremes::starts(double /*t*/, std::span<const double> y) {
  std::copy_n(y.begin(), least_.size(), least_.begin());
  greatest_ = least_;
}

void Extremes::steps(const WatchedStep& step) {
  const std::size_t columns = step.y.size();
  polynomial_.resize(static_cast<std::size_t>(step.degree) + 1);
  bounds_.resize(polynomial_.size());
  const double* const rows = step.rows();
  for (std::size_t i = 0; i < least_.size(); ++i) {
    const double* const c = rows + i;
    double reach = 0.0;
    for (int k = 1; k <= step.degree; ++k) reach += std::abs(c[k * columns]);
    const auto take = [&](double value) {
      least_[i] = std::min(least_[i], value);
      greatest_[i] = std::max(greatest_[i], value);
    };
    take(step.y[i]);
    if (c[0] - reach >= least_[i] && c[0] + reach <= greatest_[i]) continue;
    for (int k = 0; k <= step.degree; ++k) polynomial_[k] = c[k * columns];
    bernstein_form(polynomial_.data(), step.degree, bounds_.data());
    const auto [low, high] = std::ranges::minmax(bounds_);
    const double rounding = step.degree * epsilon * (std::abs(c[0]) + reach);
    if (low - rounding >= least_[i] && high + rounding <= greatest_[i]) continue;
    turning_points_.clear();
    find_turning_points(polynomial_.data(), step.degree, turning_points_);
    for (const TurningPoint& point : turning_points_) {
      if (point.theta <= step.share) take(point.value);
    }
  }
}

void Extremes::jumps(double /*t*/, std::span<const double> y) {
  for (std::size_t i = 0; i < least_.size(); ++i) {
    least_[i] = std::min(least_[i], y[i]);
    greatest_[i] = std::max(greatest_[i], y[i]);
  }
}

void Extremes::write(double* to) const {
  std::ranges::copy(greatest_, std::ranges::copy(least_, to).out);
}

void EnergyDrift::starts(double t, std::span<const double> y) {
  start_ = unexplained(t, y);
  largest_ = 0.0;
}

void EnergyDrift::jumps(double t, std::span<const double> y) {
  const double drift = std::abs(unexplained(t, y) - start_);
  if (!(drift <= largest_)) largest_ = drift;  // what is not a number stays
}

double EnergyDrift::unexplained(double t, std::span<const double> y) const {
  const std::size_t n = scene_.links.size();
  const std::span<const double> q = y.first(n);
  double energy = kinetic_energy(scene_, t, q, y.subspan(n, n)) + potential_energy(scene_, t, q);
  for (std::size_t k = 0; k < accounts_.size(); ++k) {
    const double entry = y[2 * n + k];
    energy += is_loss(accounts_[k]) ? entry : -entry;
  }
  return energy;
}

}  // namespace pendcore
