/// \file
/// The linear systems in the iteration of an implicit method for q'' = a(q, q'):
///
///     (g - J)(x, y) = (r, s),  J = ((0, 1), (A, B)):
///     (1 - h B - h^2 A) y = h (s + h A r),    x = h (r + y),    h = 1/g
///
/// for a real and for a complex h. Cost: two eliminations of half the size of J, each of n^3/3
/// products, and 2 n^2 for each right side.
///
/// The elimination is written out on Eigen's matrices, because PartialPivLU takes one and a half to
/// two and a half times as long. Both systems with three right sides take 83 ns instead of 55 for
/// two links, of some 470 ns in a step; 513 ns instead of 193 for three; 33 us instead of 21 for
/// thirty (GCC 12, x86-64-v3). Nor could it be asked to stop. From 17 rows on it works in blocks
/// (blocked_lu in PartialPivLU.h), by products of matrices whose own blocks follow the processor's
/// cache (computeProductBlockingSizes in GeneralBlockPanelKernel.h), and it divides complex numbers
/// as the compiler's library does: last bits would depend on the machine. Here no sum is Eigen's,
/// and each number changes in the order in which the loops are written.
#pragma once

#include <complex>
#include <Eigen/Core>
#include <functional>
#include <type_traits>
#include <utility>

#include "arithmetic/pack.hpp"
#include "integrate/radau/collocation.hpp"

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

  explicit NewtonSystem(int n) : matrix(n, n), pivots(n) {}

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
#pragma GCC unroll 2
      for (int i = k + 1; i < n; ++i) {
        const Number share = matrix(i, k) * matrix(k, k);
        matrix(i, k) = share;
        if (share == 0.0) continue;
#pragma GCC unroll 2
        for (int j = k + 1; j < n; ++j) matrix(i, j) -= share * matrix(k, j);
      }
    }
    return true;
  }

  /// Replaces the right sides r and s by the solution.
  template <class Side>
  PENDCORE_INLINE void solve(const Square<double>& by_q, Side& x, Side& y) const {
    const int n = static_cast<int>(matrix.rows());
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      Number sum = 0.0;
#pragma GCC unroll 2
      for (int j = 0; j < n; ++j) sum += by_q(i, j) * x[j];
      y[i] = h * (y[i] + h * sum);
    }
#pragma GCC unroll 2
    for (int k = 0; k < n - 1; ++k) {  // the last row stays
      if constexpr (links != Eigen::Dynamic) {
        // The places are constants, so that y may be in registers.
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

/// What one instruction works on: all angles and rates, if their number is known.
template <int links>
using BlockOfState = std::conditional_t<links != Eigen::Dynamic,
                                        Pack<links != Eigen::Dynamic ? 2 * links : 2>, double>;

/// Stores n angles and n rates, as a pack if that is how they are loaded (pack.hpp says why).
template <int links, class Angles, class Rates>
PENDCORE_INLINE void store_state(double* to, int n, const Angles& angles, const Rates& rates) {
  if constexpr (links != Eigen::Dynamic) {
    BlockOfState<links> both;
#pragma GCC unroll 2
    for (int i = 0; i < links; ++i) {
      set_lane(both, i, angles[i]);
      set_lane(both, links + i, rates[i]);
    }
    store(to, both);
  } else {
    for (int i = 0; i < n; ++i) to[i] = angles[i];
    for (int i = 0; i < n; ++i) to[n + i] = rates[i];
  }
}

/// The two systems of a collocation method, for angles and rates that follow each other in memory.
template <int links>
struct NewtonSystems {
  template <class Number>
  using Row = Eigen::Matrix<Number, links, 1>;
  using Square = typename NewtonSystem<double, links>::template Square<double>;

  Square by_q, by_qd;  ///< A and B. The caller fills them in.
  NewtonSystem<double, links> real;
  NewtonSystem<Complex, links> complex;

  explicit NewtonSystems(int n)
      : by_q(n, n), by_qd(n, n), real(n), complex(n), complex_x_(n), complex_y_(n) {}

  /// Factors both systems for a step of size h: g = real/h, and (alpha + i beta)/h. Calls
  /// `keep_going` from time to time; returns false if that did.
  PENDCORE_INLINE bool factor(const Collocation& method, double h,
                              const std::function<bool()>& keep_going) {
    real.g = method.real / h;
    real.h = h / method.real;
    real.matrix = -real.h * (by_qd + real.h * by_q);
    real.matrix.diagonal().array() += 1.0;
    complex.g = {method.alpha / h, method.beta / h};
    const double scale = h / (method.alpha * method.alpha + method.beta * method.beta);
    complex.h = {method.alpha * scale, -method.beta * scale};
    complex.matrix = -complex.h * by_qd - complex.h * complex.h * by_q;
    complex.matrix.diagonal().array() += 1.0;
    return real.factor(keep_going) && complex.factor(keep_going);
  }

  /// Replaces (r, s), 2n numbers, by (x, y).
  PENDCORE_INLINE void solve_real(double* sides) const {
    const int n = static_cast<int>(by_q.rows());
    Eigen::Map<Row<double>> first(sides, n);
    Eigen::Map<Row<double>> second(sides + n, n);
    if constexpr (links == Eigen::Dynamic) {
      real.solve(by_q, first, second);
    } else {
      Row<double> x = first;
      Row<double> y = second;
      real.solve(by_q, x, y);
      store_state<links>(sides, n, x, y);
    }
  }
  PENDCORE_INLINE void solve_complex(double* re, double* im) {
    const int n = static_cast<int>(by_q.rows());
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      complex_x_[i] = {re[i], im[i]};
      complex_y_[i] = {re[n + i], im[n + i]};
    }
    complex.solve(by_q, complex_x_, complex_y_);
    store_state<links>(re, n, complex_x_.real(), complex_y_.real());
    store_state<links>(im, n, complex_x_.imag(), complex_y_.imag());
  }

 private:
  Row<Complex> complex_x_, complex_y_;
};

}  // namespace pendcore
