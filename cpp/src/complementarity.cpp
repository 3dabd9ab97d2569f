#include "pendcore/dynamics/complementarity.hpp"

#include <cmath>
#include <cstddef>

namespace pendcore {
namespace {

std::size_t place(int row, int column, int n) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
         static_cast<std::size_t>(column);
}

}  // namespace

void factor_cholesky(int n, double* a) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = a[place(i, j, n)];
      for (int k = 0; k < j; ++k) sum -= a[place(i, k, n)] * a[place(j, k, n)];
      a[place(i, j, n)] = i == j ? std::sqrt(sum) : sum / a[place(j, j, n)];
    }
  }
}

void solve_lower(int n, const double* factor, double* x) {
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= factor[place(i, k, n)] * x[k];
    x[i] /= factor[place(i, i, n)];
  }
}

void solve_upper(int n, const double* factor, double* x) {
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) x[i] -= factor[place(k, i, n)] * x[k];
    x[i] /= factor[place(i, i, n)];
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
  factor_cholesky(n, factor_.data());
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

void ForcesBetweenBounds::solve() {
  auto change = [this](int i, int way) {
    const bool was_between = at[i] == Bound::between;
    at[i] = !was_between ? Bound::between : way < 0 ? Bound::lower : Bound::upper;
  };
  int least = size + 1;
  int blocks_left = 10;
  const int most = 100 + 20 * size;
  for (int round = 0; round < most; ++round) {
    solve_between();
    int count = 0;
    int last = -1;
    for (int i = 0; i < size; ++i) {
      if (wrong(i) == 0) continue;
      ++count;
      last = i;
    }
    if (count == 0) return;
    if (count < least) {
      least = count;
      blocks_left = 10;
    } else {
      --blocks_left;
    }
    if (blocks_left < 0) {
      change(last, wrong(last));
      continue;
    }
    for (int i = 0; i < size; ++i) {
      if (const int way = wrong(i); way != 0) change(i, way);
    }
  }
}

}  // namespace pendcore
