/// \file
/// The linear systems in the iteration of an implicit method for q'' = a(q, q'):
///
///     (g - J)(x, y) = (r, s),  J = ((0, 1), (A, B)):
///     (1 - h B - h^2 A) y = h (s + h A r),    x = h (r + y),    h = 1/g
///
/// for a real and for a complex h. Cost: two eliminations of half the size of J.
#pragma once

#include <functional>

#include "integrate/radau/collocation.hpp"
#include "integrate/radau/gaussian_elimination.hpp"
#include "integrate/radau/sizes.hpp"

namespace pendcore {

template <class Sizes>
struct NewtonSystems {
  template <class Number>
  using Row = typename Sizes::template Row<Number>;
  template <class Number>
  using Matrix = typename Sizes::template Matrix<Number>;

  Matrix<double> by_q, by_qd;  ///< A and B. The caller fills them in.
  double real_g = 0.0;         ///< g of the real system,
  Complex complex_g;           ///< and of the complex one

  void allocate(int n) {
    Sizes::allocate(by_q, n * n);
    Sizes::allocate(by_qd, n * n);
    Sizes::allocate(real_, n * n);
    Sizes::allocate(complex_, n * n);
    Sizes::allocate(real_pivots_, n);
    Sizes::allocate(complex_pivots_, n);
    Sizes::allocate(real_side_, n);
    Sizes::allocate(complex_side_, n);
    Sizes::allocate(complex_angle_, n);
  }

  /// Factors both systems for a step of size h: g = real/h, and (alpha + i beta)/h. Calls
  /// `keep_going` from time to time; returns false if that did.
  PENDCORE_INLINE bool factor(int n, const Collocation& method, double h,
                              const std::function<bool()>& keep_going) {
    real_g = method.real / h;
    h_ = h / method.real;
    complex_g = {method.alpha / h, method.beta / h};
    const double scale = h / (method.alpha * method.alpha + method.beta * method.beta);
    complex_h_ = {method.alpha * scale, -method.beta * scale};
    const double re = complex_h_.re;
    const double im = complex_h_.im;
    const Complex square{re * re - im * im, 2.0 * re * im};
#pragma GCC unroll 4
    for (int k = 0; k < n * n; ++k) {
      real_[k] = -h_ * (by_qd[k] + h_ * by_q[k]);
      complex_[k] = {-re * by_qd[k] - square.re * by_q[k], -im * by_qd[k] - square.im * by_q[k]};
    }
    for (int k = 0; k < n * n; k += n + 1) {
      real_[k] += 1.0;
      complex_[k].re += 1.0;
    }
    return pendcore::factor(n, real_.data(), real_pivots_.data(), keep_going) &&
           pendcore::factor(n, complex_.data(), complex_pivots_.data(), keep_going);
  }

  /// Replaces (r, s) by (x, y), 2n numbers.
  PENDCORE_INLINE void solve_real(int n, double* x) {
    const double* const s = x + n;
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      double sum = 0.0;
#pragma GCC unroll 2
      for (int j = 0; j < n; ++j) sum += by_q[i * n + j] * x[j];
      real_side_[i] = h_ * (s[i] + h_ * sum);
    }
    solve_factored(n, real_.data(), real_pivots_.data(), real_side_.data());
    const auto rate = [this](int i) __attribute__((always_inline)) { return real_side_[i]; };
    const auto angle = [&](int i) __attribute__((always_inline)) { return h_ * (x[i] + rate(i)); };
    Sizes::store_state(x, n, angle, rate);
  }
  PENDCORE_INLINE void solve_complex(int n, double* re, double* im) {
    const Complex h = complex_h_;
    auto times_h = [h](double x, double y) {
      return Complex{h.re * x - h.im * y, h.re * y + h.im * x};
    };
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      double of_re = 0.0;
      double of_im = 0.0;
#pragma GCC unroll 2
      for (int j = 0; j < n; ++j) {
        of_re += by_q[i * n + j] * re[j];
        of_im += by_q[i * n + j] * im[j];
      }
      const Complex moved = times_h(of_re, of_im);
      complex_side_[i] = times_h(re[n + i] + moved.re, im[n + i] + moved.im);
    }
    solve_factored(n, complex_.data(), complex_pivots_.data(), complex_side_.data());
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      complex_angle_[i] = times_h(re[i] + complex_side_[i].re, im[i] + complex_side_[i].im);
    }
    Sizes::store_state(
        re, n, [this](int i) __attribute__((always_inline)) { return complex_angle_[i].re; },
        [this](int i) __attribute__((always_inline)) { return complex_side_[i].re; });
    Sizes::store_state(
        im, n, [this](int i) __attribute__((always_inline)) { return complex_angle_[i].im; },
        [this](int i) __attribute__((always_inline)) { return complex_side_[i].im; });
  }

 private:
  double h_ = 0.0;  ///< 1/g
  Complex complex_h_;
  Matrix<double> real_;  ///< the factors
  Matrix<Complex> complex_;
  Row<int> real_pivots_, complex_pivots_;
  Row<double> real_side_;
  Row<Complex> complex_side_, complex_angle_;
};

}  // namespace pendcore
