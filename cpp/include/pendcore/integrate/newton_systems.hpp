/// \file
/// The linear systems of an implicit method's iteration, of q'' = a(q, q'):
///
///     (g - J)(x, y) = (r, s),  J = ((0, 1), (A, B)):
///     (g^2 - g B - A) y = g s + A r,    x = (r + y)/g
///
/// for a real g and a complex one. Cost: two eliminations of half the size of J.
#pragma once

#include "pendcore/integrate/collocation.hpp"
#include "pendcore/integrate/elimination.hpp"

namespace pendcore {

class NewtonSystems {
 public:
  void resize(int n);

  /// A and B, (n, n) each: filled in here.
  double* by_q() { return by_q_.data(); }
  double* by_qd() { return by_qd_.data(); }

  /// Makes both systems for a step of size h: g = real/h, and (alpha + i beta)/h.
  void factor(const Collocation& method, double h);
  double real() const { return g_; }
  Complex complex() const { return complex_g_; }

  /// From (r, s) to (x, y), (2n) numbers, in place.
  void solve_real(double* x);
  void solve_complex(double* re, double* im);

 private:
  int n_ = 0;
  std::vector<double> by_q_, by_qd_;
  double g_ = 0.0;
  Complex complex_g_;
  Elimination<double> real_;
  Elimination<Complex> complex_;
  std::vector<double> real_side_;
  std::vector<Complex> complex_side_;
};

}  // namespace pendcore
