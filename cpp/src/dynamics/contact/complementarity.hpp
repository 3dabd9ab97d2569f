/// \file
/// Forces between bounds: the complementarity problem that decides which joints stay at rest.
///
///     w = a + W lambda,   lower <= lambda <= upper
///     w_i = 0 where lambda_i is between its bounds, w_i >= 0 at the lower, w_i <= 0 at the upper
///
/// Since W is positive definite there is exactly one solution, the minimum of 1/2 lambda.W lambda +
/// a.lambda between the bounds. With a and w accelerations of joints and lambda the torques of
/// friction and stops, the solution says which joints stay at rest; with rates and impulses, it
/// says how an impact ends. The solver changes all forces that violate their conditions at once
/// (Judice and Pires, Computers & Operations Research 21 (1994) 587). Where this cycles, it
/// descends between the bounds by Newton's method with projections (Bertsekas, SIAM J. Control and
/// Optimization 20 (1982) 221).
#pragma once

#include <functional>
#include <vector>

#include "pendcore/vector.hpp"

namespace pendcore {

enum class Bound : signed char { lower = -1, between = 0, upper = 1 };

struct ForcesBetweenBounds {
  int size = 0;
  Matrix W;  ///< (size, size), symmetric, positive definite
  Vector a, lower, upper;
  Vector lambda, w;       ///< the solution
  std::vector<Bound> at;  ///< where each force of the solution is

  /// Called from time to time in long computations; it may throw.
  std::function<void()> look;

  void resize(int count);
  /// Returns false if it has not found the solution.
  bool solve();

  /// Factors the part of W of the forces that are between their bounds in the solution.
  void factor_between();
  /// The forces that change w by -slip where the solution is between its bounds, and are 0
  /// elsewhere, from these factors.
  Vector forces_against(const Vector& slip) const;

 private:
  void solve_between();
  int wrong(int i) const;
  bool descend();
  Vector slope_at(const Vector& x) const;
  bool goes_down(const Vector& from, const Vector& slope) const;
  double rounding(int i) const;  ///< what rounding may add to w_i
  Matrix factor_;
  std::vector<int> free_;
};

/// Computes A = L D L^T in place of the lower half of A, with D on the diagonal. The order of
/// operations is fixed and there are no square roots, so that units twice as large change no bit
/// of the mantissas. Eigen's LDLT, which chooses pivots and sums in blocks, promises neither.
void factor_symmetric(Matrix& A);
/// solve_lower() replaces x, which is zero before `first`, by L^-1 x; solve_upper() replaces x by
/// L^-T D^-1 x.
void solve_lower(const Matrix& factor, Eigen::Ref<Vector> x, int first = 0);
void solve_upper(const Matrix& factor, Eigen::Ref<Vector> x);

}  // namespace pendcore
