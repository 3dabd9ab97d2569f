/// \file
/// Gaussian elimination with partial pivoting, real and complex, in a fixed order of operations.
///
/// Complex numbers are written out as reals, and a pivot is chosen by |re| + |im|. Source: Golub
/// and Van Loan, Matrix Computations, 3.4. Cost: n^3/3 multiplications of the number type, and n^2
/// for each right side. It allocates once. A singular matrix gives numbers that are not finite.
#pragma once

#include <functional>
#include <vector>

namespace pendcore {

struct Complex {
  double re = 0.0;
  double im = 0.0;
};

template <class Number>
class GaussianElimination {
 public:
  GaussianElimination() = default;
  explicit GaussianElimination(int n) { resize(n); }
  void resize(int n) {
    n_ = n;
    matrix_.resize(static_cast<std::size_t>(n) * n);
    pivots_.resize(n);
  }

  /// The matrix, (n, n) row-major. The caller fills it in, and factor() replaces it by its factors.
  Number* matrix() { return matrix_.data(); }
  /// Factors the matrix. Calls `keep_going` from time to time, if it is given; returns false if
  /// that did.
  bool factor(const std::function<bool()>& keep_going = nullptr);
  /// Replaces a right side (n) by the solution.
  void solve(Number* x) const;

 private:
  int n_ = 0;
  std::vector<Number> matrix_;
  std::vector<int> pivots_;
};

}  // namespace pendcore
