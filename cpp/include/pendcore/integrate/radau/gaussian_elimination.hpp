/// \file
/// Gaussian elimination with partial pivoting, real and complex, in an order that nothing changes.
///
/// Complex numbers are written out in reals, and a pivot is chosen by |re| + |im|. Source: Golub
/// and Van Loan, Matrix Computations, 3.4. Cost: n^3/3 multiplications of the number, and n^2 for
/// each right side. Allocates once; a singular matrix gives what is not finite.
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

  /// (n, n) row-major: filled in here, and then factored in place.
  Number* matrix() { return matrix_.data(); }
  /// Asks now and then whether to go on, if that is given; false where it was told not to.
  bool factor(const std::function<bool()>& keep_going = nullptr);
  /// From a right side (n) to the solution, in place.
  void solve(Number* x) const;

 private:
  int n_ = 0;
  std::vector<Number> matrix_;
  std::vector<int> pivots_;
};

}  // namespace pendcore
