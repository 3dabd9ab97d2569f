#include "pendcore/dynamics/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pendcore/arithmetic/epsilon.hpp"

namespace pendcore {
namespace {

std::size_t place(int row, int column, int n) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
         static_cast<std::size_t>(column);
}

}  // namespace

void factor_symmetric(int n, double* a) {
  for (int i = 0; i < n; ++i) {
    double* const row = a + place(i, 0, n);
    for (int j = 0; j < i; ++j) {  // L D for now
      for (int k = 0; k < j; ++k) row[j] -= row[k] * a[place(j, k, n)];
    }
    for (int j = 0; j < i; ++j) {
      const double of_both = row[j];
      row[j] /= a[place(j, j, n)];
      row[i] -= of_both * row[j];
    }
  }
}

void solve_lower(int n, const double* factor, double* x) {
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= factor[place(i, k, n)] * x[k];
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

/// lambda where it is between the bounds, so that w = 0 there; and all w.
void ForcesBetweenBounds::solve_between() {
  free_.clear();
  for (int i = 0; i < size; ++i) {
    if (at[i] == Bound::between) free_.push_back(i);
    lambda[i] = at[i] == Bound::lower ? lower[i] : at[i] == Bound::upper ? upper[i] : 0.0;
  }
  const int n = static_cast<int>(free_.size());
  factor_.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  std::vector<double> x(free_.size());
  for (int i = 0; i < n; ++i) {
    double sum = a[free_[i]];
    for (int j = 0; j < size; ++j) sum += W[place(free_[i], j, size)] * lambda[j];
    x[i] = -sum;
    for (int j = 0; j <= i; ++j) factor_[place(i, j, n)] = W[place(free_[i], free_[j], size)];
  }
  factor_symmetric(n, factor_.data());
  solve_lower(n, factor_.data(), x.data());
  solve_upper(n, factor_.data(), x.data());
  for (int i = 0; i < n; ++i) lambda[free_[i]] = x[i];
  for (int i = 0; i < size; ++i) {
    w[i] = 0.0;
    if (at[i] == Bound::between) continue;
    w[i] = a[i];
    for (int j = 0; j < size; ++j) w[i] += W[place(i, j, size)] * lambda[j];
  }
}

/// Which way force i is wrong where it is: below its range -1, above it 1, or what its bound says
/// of its w; 0 where it is right.
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

/// From forces within the bounds downhill, until a bound is in the way or what is free is at its
/// least; then the bound is let go that is wrong by most.
bool ForcesBetweenBounds::descend() {
  for (int i = 0; i < size; ++i) {
    lambda[i] = std::clamp(lambda[i], lower[i], upper[i]);
    at[i] = lambda[i] == lower[i]   ? Bound::lower
            : lambda[i] == upper[i] ? Bound::upper
                                    : Bound::between;
  }
  for (int round = 0; round < 100 + 20 * size; ++round) {
    const std::vector<double> from = lambda;
    solve_between();
    double share = 1.0;
    int first = -1;
    Bound met = Bound::between;
    for (int i = 0; i < size; ++i) {
      const int way = at[i] == Bound::between ? wrong(i) : 0;
      if (way == 0) continue;
      const double bound = way < 0 ? lower[i] : upper[i];
      const double until = (bound - from[i]) / (lambda[i] - from[i]);
      if (first >= 0 && until >= share) continue;
      share = until;
      first = i;
      met = way < 0 ? Bound::lower : Bound::upper;
    }
    if (first >= 0) {
      for (int i = 0; i < size; ++i) lambda[i] = from[i] + share * (lambda[i] - from[i]);
      at[first] = met;
      lambda[first] = met == Bound::lower ? lower[first] : upper[first];
      continue;
    }
    int worst = -1;
    for (int i = 0; i < size; ++i) {
      if (wrong(i) == 0 || std::abs(w[i]) <= rounding(i)) continue;
      if (worst < 0 || std::abs(w[i]) > std::abs(w[worst])) worst = i;
    }
    if (worst < 0) return true;
    at[worst] = Bound::between;
  }
  return false;
}

double ForcesBetweenBounds::rounding(int i) const {
  double sum = std::abs(a[i]);
  for (int j = 0; j < size; ++j) sum += std::abs(W[place(i, j, size)] * lambda[j]);
  return 64.0 * epsilon * sum;
}

}  // namespace pendcore
