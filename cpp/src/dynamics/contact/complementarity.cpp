#include "dynamics/contact/complementarity.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"

namespace pendcore {

void factor_symmetric(Matrix& A) {
  const Eigen::Index n = A.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index rest = n - k - 1;
    const Vector column = A.col(k).tail(rest) / A(k, k);
    for (Eigen::Index i = 0; i < rest; ++i) {  // the remaining part of A, row by row
      auto row = A.row(k + 1 + i);
      row.segment(k + 1, i + 1) -= row(k) * column.head(i + 1).transpose();
    }
    A.col(k).tail(rest) = column;
  }
}

void solve_lower(const Matrix& factor, Eigen::Ref<Vector> x, int first) {
  for (Eigen::Index k = first; k + 1 < x.size(); ++k) {
    const Eigen::Index rest = x.size() - k - 1;
    x.tail(rest) -= x(k) * factor.col(k).tail(rest);
  }
}

void solve_upper(const Matrix& factor, Eigen::Ref<Vector> x) {
  for (Eigen::Index i = x.size() - 1; i >= 0; --i) {
    x(i) /= factor(i, i);
    for (Eigen::Index k = i + 1; k < x.size(); ++k) x(i) -= factor(k, i) * x(k);
  }
}

void ForcesBetweenBounds::resize(int count) {
  size = count;
  W.setZero(count, count);
  for (Vector* row : {&a, &lower, &upper, &lambda, &w}) row->setZero(count);
  at.assign(count, Bound::between);
}

void ForcesBetweenBounds::factor_between() {
  free_.clear();
  for (int i = 0; i < size; ++i) {
    if (at[i] == Bound::between) free_.push_back(i);
  }
  factor_ = W(free_, free_);
  factor_symmetric(factor_);
}

Vector ForcesBetweenBounds::forces_against(const Vector& slip) const {
  Vector x = -slip(free_);
  solve_lower(factor_, x);
  solve_upper(factor_, x);
  Vector forces = Vector::Zero(slip.size());
  forces(free_) = x;
  return forces;
}

/// Solves for the forces between the bounds, such that w = 0 there, and computes all w.
void ForcesBetweenBounds::solve_between() {
  if (look) look();
  factor_between();
  for (int i = 0; i < size; ++i) {
    lambda(i) = at[i] == Bound::lower ? lower(i) : at[i] == Bound::upper ? upper(i) : 0.0;
  }
  const Vector forces = forces_against(slope_at(lambda));
  lambda(free_) = forces(free_);
  w = slope_at(lambda);
  w(free_).setZero();
}

/// How force i violates its condition; 0 if it does not. For a force between the bounds it is -1
/// below the range and 1 above it. For a force at a bound it is the sign of the change of lambda
/// that w calls for: 1 at the lower bound, -1 at the upper.
int ForcesBetweenBounds::wrong(int i) const {
  switch (at[i]) {
    case Bound::between: return lambda(i) < lower(i) ? -1 : lambda(i) > upper(i) ? 1 : 0;
    case Bound::lower: return w(i) < 0.0 ? 1 : 0;
    case Bound::upper: return w(i) > 0.0 ? -1 : 0;
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
  lambda = lambda.cwiseMax(lower).cwiseMin(upper);
  for (int round = 0; round < 100 + size; ++round) {
    const Vector from = lambda;
    const Vector slope = slope_at(from);
    bool is_least = true;
    for (int i = 0; i < size; ++i) {
      const bool stays_lower = from(i) == lower(i) && slope(i) >= 0.0;
      const bool stays_upper = from(i) == upper(i) && slope(i) <= 0.0;
      at[i] = stays_lower ? Bound::lower : stays_upper ? Bound::upper : Bound::between;
      const bool is_flat = at[i] != Bound::between || std::abs(slope(i)) <= rounding(i);
      is_least = is_least && is_flat;
    }
    if (is_least) {
      w = slope;
      return true;
    }
    solve_between();
    const Vector to = lambda;
    double share = 1.0;
    bool is_lower = false;
    for (int halvings = 0; halvings <= most_halvings && !is_lower; ++halvings, share *= 0.5) {
      lambda = (from + share * (to - from)).cwiseMax(lower).cwiseMin(upper);
      is_lower = goes_down(from, slope);
    }
    if (!is_lower) {  // this is the minimum in double precision
      lambda = from;
      w = slope;
      return true;
    }
  }
  return false;
}

/// W x + a, the gradient of 1/2 x.W x + a.x. Each entry is summed in the order of x.
Vector ForcesBetweenBounds::slope_at(const Vector& x) const {
  Vector slope = a;
  for (int j = 0; j < size; ++j) slope += x(j) * W.col(j);
  return slope;
}

/// Whether the objective is lower at lambda than at `from`, by at least a tenth of what the
/// gradient at `from` predicts.
bool ForcesBetweenBounds::goes_down(const Vector& from, const Vector& slope) const {
  double promised = 0.0;
  double curved = 0.0;
  for (int i = 0; i < size; ++i) {
    const double change = lambda(i) - from(i);
    promised += slope(i) * change;
    double along = 0.0;
    for (int j = 0; j < size; ++j) along += W(i, j) * (lambda(j) - from(j));
    curved += 0.5 * change * along;
  }
  return promised < 0.0 && promised + curved <= 0.1 * promised;
}

double ForcesBetweenBounds::rounding(int i) const {
  double sum = std::abs(a(i));
  for (int j = 0; j < size; ++j) sum += std::abs(W(i, j) * lambda(j));
  return 64.0 * epsilon * sum;
}

}  // namespace pendcore
