/// \file
/// The linear systems in the iteration of an implicit method for q'' = a(q, q'):
///
///     (g - J)(x, y) = (r, s),  J = ((0, 1), (A, B)):
///     (1 - h B - h^2 A) y = h (s + h A r),    x = h (r + y),    h = 1/g
///
/// for a real and for a complex h. Cost: two eliminations of half the size of J.
#pragma once

#include "pendcore/integrate/radau/collocation.hpp"
#include "pendcore/integrate/radau/gaussian_elimination.hpp"

namespace pendcore {

class NewtonSystems {
 public:
  void resize(int n);

  /// A and B, (n, n) each. The caller fills them in.
  double* by_q() { return by_q_.data(); }
  double* by_qd() { return by_qd_.data(); }

  /// Factors both systems for a step of size h: g = real/h, and (alpha + i beta)/h. Calls
  /// `keep_going` from time to time; returns false if that did.
  bool factor(const Collocation& method, double h, const std::function<bool()>& keep_going);
  double real() const { return g_; }              ///< g
  Complex complex() const { return complex_g_; }  ///< g

  /// Replaces (r, s) by (x, y), 2n numbers.
  void solve_real(double* x);
  void solve_complex(double* re, double* im);

 private:
  int n_ = 0;
  std::vector<double> by_q_, by_qd_;
  double g_ = 0.0;
  double h_ = 0.0;  ///< 1/g
  Complex complex_g_, complex_h_;
  GaussianElimination<double> real_;
  GaussianElimination<Complex> complex_;
  std::vector<double> real_side_;
  std::vector<Complex> complex_side_;
};

}  // namespace pendcore
