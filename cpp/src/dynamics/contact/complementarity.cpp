#include "dynamics/contact/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "arithmetic/epsilon.hpp"

namespace pendcore {
namespace {

std::size_t place(int row, int column, int n) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
         static_cast<std::size_t>(column);
}

}  // namespace

void factor_symmetric(int n, double* a) {
  std::vector<double> column(n);
  for (int k = 0; k < n; ++k) {
    for (int i = k + 1; i < n; ++i) column[i] = a[place(i, k, n)] / a[place(k, k, n)];
    for (int i = k + 1; i < n; ++i) {  // the remaining part of A, row by row
      double* const row = a + place(i, 0, n);
      const double of_both = row[k];  // L D
      for (int j = k + 1; j <= i; ++j) row[j] -= of_both * column[j];
      row[k] = column[i];
    }
  }
}

void solve_lower(int n, const double* factor, double* x, int first) {
  for (int i = first; i < n; ++i) {
    for (int k = first; k < i; ++k) x[i] -= factor[place(i, k, n)] * x[k];
  }
}

void solve_upper(int n, const double* factor, double* x) {
  for (int i = n - 1; i >= 0; --i) {
    x[i] /= factor[place(i, i, n)];
    for (int k = i + 1; k < n; ++k) x[i] -= factor[place(k, i, n)] * x[k];
  }
}

void ForcesBetweenBounds::resize(int count) {
  size = count;
  const auto n = static_cast<std::size_t>(count);
  W.assign(n * n, 0.0);
  for (std::vector<double>* row : {&a, &lower, &upper, &lambda, &w}) row->assign(n, 0.0);
  at.assign(n, Bound::between);
}

void ForcesBetweenBounds::factor_between() {
  free_.clear();
  for (int i = 0; i < size; ++i) {
    if (at[i] == Bound::between) free_.push_back(i);
  }
  const int n = static_cast<int>(free_.size());
  factor_.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) factor_[place(i, j, n)] = W[place(free_[i], free_[j], size)];
  }
  factor_symmetric(n, factor_.data());
}

std::vector<double> ForcesBetweenBounds::forces_against(const std::vector<double>& slip) const {
  const int n = static_cast<int>(free_.size());
  std::vector<double> x(free_.size());
  for (int i = 0; i < n; ++i) x[i] = -slip[free_[i]];
  solve_lower(n, factor_.data(), x.data());
  solve_upper(n, factor_.data(), x.data());
  std::vector<double> forces(slip.size(), 0.0);
  for (int i = 0; i < n; ++i) forces[free_[i]] = x[i];
  return forces;
}

/// Solves for the forces between the bounds, such that w = 0 there, and computes all w.
void ForcesBetweenBounds::solve_between() {
  if (look) look();
  factor_between();
  for (int i = 0; i < size; ++i) {
    lambda[i] = at[i] == Bound::lower ? lower[i] : at[i] == Bound::upper ? upper[i] : 0.0;
  }
  std::vector<double> slip(lambda.size());
  for (const int i : free_) {
    slip[i] = a[i];
    for (int j = 0; j < size; ++j) slip[i] += W[place(i, j, size)] * lambda[j];
  }
  const std::vector<double> forces = forces_against(slip);
  for (const int i : free_) lambda[i] = forces[i];
  for (int i = 0; i < size; ++i) {
    w[i] = 0.0;
    if (at[i] == Bound::between) continue;
    w[i] = a[i];
    for (int j = 0; j < size; ++j) w[i] += W[place(i, j, size)] * lambda[j];
  }
}

/// How force i violates its condition; 0 if it does not. For a force between the bounds it is -1
/// below the range and 1 above it. For a force at a bound it is the sign of the change of lambda
/// that w calls for: 1 at the lower bound, -1 at the upper.
int ForcesBetweenBounds::wrong(int i) const {
  switch (at[i]) {
    case Bound::between: return lambda[i] < lower[i] ? -1 : lambda[i] > upper[i] ? 1 : 0;
    case Bound::lower: return w[i] < 0.0 ? 1 : 0;
    case Bound::upper: return w[i] > 0.0 ? -1 : 0;
  }
  return 0;
}

bool ForcesBetweenBounds::solve() {
  int least = size + 1;
  for (int blocks_left = 10; blocks_left > 0; --blocks_left) {
    solve_between();
    int count = 0;
    for (int i = 0; i < size; ++i) count += wrong(i) != 0 ? 1 : 0;
    if (count == 0) return true;
    if (count < least) blocks_left = 10;
    least = std::min(least, count);
    for (int i = 0; i < size; ++i) {
      const int way = wrong(i);
      if (way == 0) continue;
      const bool was_between = at[i] == Bound::between;
      at[i] = !was_between ? Bound::between : way < 0 ? Bound::lower : Bound::upper;
    }
  }
  return descend();
}

/// Goes downhill from forces within the bounds. Each step leads towards the minimum over the forces
/// that are free to move, is projected on the bounds, and is halved until it descends enough.
bool ForcesBetweenBounds::descend() {
  constexpr int most_halvings = 52;  // the digits of a double
  for (int i = 0; i < size; ++i) lambda[i] = std::clamp(lambda[i], lower[i], upper[i]);
  std::vector<double> from(lambda);
  std::vector<double> slope(lambda.size());
  for (int round = 0; round < 100 + size; ++round) {
    from = lambda;
    slope_at(from, slope);
    bool is_least = true;
    for (int i = 0; i < size; ++i) {
      const bool stays_lower = from[i] == lower[i] && slope[i] >= 0.0;
      const bool stays_upper = from[i] == upper[i] && slope[i] <= 0.0;
      at[i] = stays_lower ? Bound::lower : stays_upper ? Bound::upper : Bound::between;
      const bool is_flat = at[i] != Bound::between || std::abs(slope[i]) <= rounding(i);
      is_least = is_least && is_flat;
    }
    if (is_least) {
      w = std::move(slope);
      return true;
    }
    solve_between();
    const std::vector<double> to = lambda;
    double share = 1.0;
    bool is_lower = false;
    for (int halvings = 0; halvings <= most_halvings && !is_lower; ++halvings, share *= 0.5) {
      for (int i = 0; i < size; ++i) {
        lambda[i] = std::clamp(from[i] + share * (to[i] - from[i]), lower[i], upper[i]);
      }
      is_lower = goes_down(from, slope);
    }
    if (!is_lower) {  // this is the minimum in double precision
      lambda = std::move(from);
      w = std::move(slope);
      return true;
    }
  }
  return false;
}

/// Computes W x + a, the gradient of 1/2 x.W x + a.x.
void ForcesBetweenBounds::slope_at(const std::vector<double>& x, std::vector<double>& slope) const {
  for (int i = 0; i < size; ++i) {
    slope[i] = a[i];
    for (int j = 0; j < size; ++j) slope[i] += W[place(i, j, size)] * x[j];
  }
}

/// Whether the objective is lower at lambda than at `from`, by at least a tenth of what the
/// gradient at `from` predicts.
bool ForcesBetweenBounds::goes_down(const std::vector<double>& from,
                                    const std::vector<double>& slope) const {
  double promised = 0.0;
  double curved = 0.0;
  for (int i = 0; i < size; ++i) {
    const double change = lambda[i] - from[i];
    promised += slope[i] * change;
    double along = 0.0;
    for (int j = 0; j < size; ++j) along += W[place(i, j, size)] * (lambda[j] - from[j]);
    curved += 0.5 * change * along;
  }
  return promised < 0.0 && promised + curved <= 0.1 * promised;
}

double ForcesBetweenBounds::rounding(int i) const {
  double sum = std::abs(a[i]);
  for (int j = 0; j < size; ++j) sum += std::abs(W[place(i, j, size)] * lambda[j]);
  return 64.0 * epsilon * sum;
}

}  // namespace pendcore
