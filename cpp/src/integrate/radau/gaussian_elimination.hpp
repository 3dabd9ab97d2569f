/// \file
/// Gaussian elimination with partial pivoting, real and complex, in a fixed order of operations.
///
/// Complex numbers are written out as reals, and a pivot is chosen by |re| + |im|. Source: Golub
/// and Van Loan, Matrix Computations, 3.4. Cost: n^3/3 multiplications of the number type, and n^2
/// for each right side. A singular matrix gives numbers that are not finite.
///
/// A kernel that knows n gets loops that are unrolled.
#pragma once

#include <functional>
#include <vector>

#include "arithmetic/pack.hpp"

namespace pendcore {

struct Complex {
  double re = 0.0;
  double im = 0.0;
};

namespace elimination_detail {

PENDCORE_INLINE double size(double x) { return __builtin_fabs(x); }
PENDCORE_INLINE double size(const Complex& x) {
  return __builtin_fabs(x.re) + __builtin_fabs(x.im);
}

PENDCORE_INLINE double inverse(double x) { return 1.0 / x; }
PENDCORE_INLINE Complex inverse(const Complex& x) {
  // Dividing by the larger part first (Smith 1962) avoids squares that overflow.
  if (__builtin_fabs(x.re) >= __builtin_fabs(x.im)) {
    const double ratio = x.im / x.re;
    const double scale = 1.0 / (x.re + x.im * ratio);
    return {scale, -ratio * scale};
  }
  const double ratio = x.re / x.im;
  const double scale = 1.0 / (x.re * ratio + x.im);
  return {ratio * scale, -scale};
}

PENDCORE_INLINE double product(double x, double y) { return x * y; }
PENDCORE_INLINE Complex product(const Complex& x, const Complex& y) {
  return {x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re};
}

/// x -= y z
PENDCORE_INLINE void subtract(double& x, double y, double z) { x -= y * z; }
PENDCORE_INLINE void subtract(Complex& x, const Complex& y, const Complex& z) {
  x.re -= y.re * z.re - y.im * z.im;
  x.im -= y.re * z.im + y.im * z.re;
}

template <class Number>
PENDCORE_INLINE void exchange(Number& a, Number& b) {
  const Number before = a;
  a = b;
  b = before;
}

}  // namespace elimination_detail

/// Replaces the matrix a, (n, n) row-major, by its factors; `pivots` has n numbers. Calls
/// `keep_going` from time to time, if it is given; returns false if that did.
template <class Number>
PENDCORE_INLINE bool factor(int n, Number* a, int* pivots,
                            const std::function<bool()>& keep_going) {
  using namespace elimination_detail;
  constexpr int between = 16;  // rows
#pragma GCC unroll 2
  for (int k = 0; k < n; ++k) {
    if (k % between == between - 1 && keep_going && !keep_going()) return false;
    int pivot = k;
#pragma GCC unroll 2
    for (int i = k + 1; i < n; ++i) {
      if (size(a[i * n + k]) > size(a[pivot * n + k])) pivot = i;
    }
    pivots[k] = pivot;
    if (pivot != k) {
#pragma GCC unroll 2
      for (int j = 0; j < n; ++j) exchange(a[k * n + j], a[pivot * n + j]);
    }
    // The diagonal is kept inverted.
    a[k * n + k] = inverse(a[k * n + k]);
#pragma GCC unroll 2
    for (int i = k + 1; i < n; ++i) {
      const Number share = product(a[i * n + k], a[k * n + k]);
      a[i * n + k] = share;
      if (size(share) == 0.0) continue;
#pragma GCC unroll 2
      for (int j = k + 1; j < n; ++j) subtract(a[i * n + j], share, a[k * n + j]);
    }
  }
  return true;
}

/// Replaces a right side (n) by the solution.
template <class Number>
PENDCORE_INLINE void solve_factored(int n, const Number* a, const int* pivots, Number* x) {
  using namespace elimination_detail;
#pragma GCC unroll 2
  for (int k = 0; k < n - 1; ++k) {  // the last row stays
    if (__builtin_constant_p(n)) {   // the places are constants, so that x may be in registers
#pragma GCC unroll 2
      for (int i = k + 1; i < n; ++i) {
        if (pivots[k] == i) exchange(x[k], x[i]);
      }
    } else {
      exchange(x[k], x[pivots[k]]);
    }
  }
#pragma GCC unroll 2
  for (int i = 1; i < n; ++i) {
#pragma GCC unroll 2
    for (int j = 0; j < i; ++j) subtract(x[i], a[i * n + j], x[j]);
  }
#pragma GCC unroll 2
  for (int i = n - 1; i >= 0; --i) {
#pragma GCC unroll 2
    for (int j = i + 1; j < n; ++j) subtract(x[i], a[i * n + j], x[j]);
    x[i] = product(x[i], a[i * n + i]);
  }
}

}  // namespace pendcore
