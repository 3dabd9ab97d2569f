/// \file
/// A linear system in the iteration of an implicit method for q'' = a(q, q'):
///
///     (g - J)(x, y) = (r, s),  J = ((0, 1), (A, B)):
///     (1 - h B - h^2 A) y = h (s + h A r),    x = h (r + y),    h = 1/g
///
/// for a real or a complex h. Cost: an elimination of half the size of J, with n^3/3 products, and
/// 2 n^2 for each right side.
///
/// The elimination is written out on Eigen's matrices, because PartialPivLU takes twice as long for
/// any number of links: 100 ns instead of 55 for both systems of two links with three right sides,
/// which is a tenth of a step, and 34 us instead of 18 for thirty links (GCC 12, Xeon 2.6 GHz). Nor
/// could it be asked to stop. Beyond 16 rows it works in blocks (blocked_lu in PartialPivLU.h), by
/// products of matrices whose blocks follow the processor's cache (GeneralBlockPanelKernel.h), and
/// it divides complex numbers by the compiler's library: two more reasons for other last bits on
/// another machine. Here no sum is Eigen's: each row is changed number by number.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <utility>

#include "arithmetic/instruction_set.hpp"

namespace pendcore {

using Complex = std::complex<double>;

PENDCORE_INLINE double inverse(double x) { return 1.0 / x; }
PENDCORE_INLINE Complex inverse(const Complex& x) {
  const double re = x.real();
  const double im = x.imag();
  // Dividing by the larger part first (Smith 1962) avoids squares that overflow.
  if (__builtin_fabs(re) >= __builtin_fabs(im)) {
    const double ratio = im / re;
    const double scale = 1.0 / (re + im * ratio);
    return {scale, -ratio * scale};
  }
  const double ratio = re / im;
  const double scale = 1.0 / (re * ratio + im);
  return {ratio * scale, -scale};
}

/// The system of `links` links, or of any number of them (Eigen::Dynamic). A kernel that knows the
/// number gets loops that are unrolled.
template <class Number, int links>
struct NewtonSystem {
  template <class Any>
  using Row = Eigen::Matrix<Any, links, 1>;
  template <class Any>
  using Square = Eigen::Matrix<Any, links, links, Eigen::RowMajor>;

  Number g{}, h{};
  Square<Number> matrix;  ///< 1 - h B - h^2 A, and then its factors
  Row<int> pivots;
  Row<Number> x, y;  ///< the right sides r and s, and then the solution

  explicit NewtonSystem(int n) : matrix(n, n), pivots(n), x(n), y(n) {}

  /// Replaces the matrix by its factors, by Gaussian elimination with partial pivoting (Golub and
  /// Van Loan, Matrix Computations, 3.4). A singular matrix gives numbers that are not finite.
  /// Calls `keep_going` from time to time, if it is given; returns false if that did.
  PENDCORE_INLINE bool factor(const std::function<bool()>& keep_going) {
    using Eigen::numext::norm1;
    constexpr int between = 16;  // rows
    const int n = static_cast<int>(matrix.rows());
#pragma GCC unroll 2
    for (int k = 0; k < n; ++k) {
      if (k % between == between - 1 && keep_going && !keep_going()) return false;
      int pivot = k;
#pragma GCC unroll 2
      for (int i = k + 1; i < n; ++i) {
        if (norm1(matrix(i, k)) > norm1(matrix(pivot, k))) pivot = i;
      }
      pivots[k] = pivot;
      if (pivot != k) matrix.row(k).swap(matrix.row(pivot));
      matrix(k, k) = inverse(matrix(k, k));  // the diagonal is kept inverted
      const int left = n - k - 1;
#pragma GCC unroll 2
      for (int i = k + 1; i < n; ++i) {
        const Number share = matrix(i, k) * matrix(k, k);
        matrix(i, k) = share;
        if (share == 0.0) continue;
        matrix.row(i).tail(left) -= share * matrix.row(k).tail(left);
      }
    }
    return true;
  }

  /// Replaces the right sides by the solution.
  PENDCORE_INLINE void solve(const Square<double>& by_q) {
    const int n = static_cast<int>(matrix.rows());
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      Number sum = 0.0;
#pragma GCC unroll 2
      for (int j = 0; j < n; ++j) sum += by_q(i, j) * x[j];
      y[i] = h * (y[i] + h * sum);
    }
#pragma GCC unroll 2
    for (int k = 0; k < n - 1; ++k) {     // the last row stays
      if constexpr (links != Eigen::Dynamic) {  // the places are constants, so that y may be in registers
#pragma GCC unroll 2
        for (int i = k + 1; i < links; ++i) {
          if (pivots[k] == i) std::swap(y[k], y[i]);
        }
      } else {
        std::swap(y[k], y[pivots[k]]);
      }
    }
#pragma GCC unroll 2
    for (int i = 1; i < n; ++i) {
#pragma GCC unroll 2
      for (int j = 0; j < i; ++j) y[i] -= matrix(i, j) * y[j];
    }
#pragma GCC unroll 2
    for (int i = n - 1; i >= 0; --i) {
#pragma GCC unroll 2
      for (int j = i + 1; j < n; ++j) y[i] -= matrix(i, j) * y[j];
      y[i] *= matrix(i, i);
    }
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) x[i] = h * (x[i] + y[i]);
  }
};

}  // namespace pendcore
