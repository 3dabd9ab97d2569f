/// \file
/// The table of an implicit collocation method with three stages.
///
///     Z_i = h sum_j a_ij f(t + c_i h, y + Z_j),     y_new = y + Z_3,  c_3 = 1
///     u(t + theta h) = y + sum_p theta^p sum_i P_pi Z_i,  p = 1 .. 3
///
/// u' equals f at the three stages, but not at the start. The polynomial of degree 4 for which both
/// is true,
///
///     y(t + theta h) = u(t + theta h) + K(theta)/K'(0) (h f(t, y) - h u'(t)),
///     K(theta) = integral of (x - c_1)(x - c_2)(x - 1), from 0 to theta;  K(1) = 0
///
/// is of order 4, and has no corners between steps.
///
/// The matrix T takes the inverse of a to a real number and a complex one,
///
///     T^-1 a^-1 T = ((real, 0, 0), (0, alpha, -beta), (0, beta, alpha)),
///
/// so that the stages come from one real and one complex system of the size of the state.
#pragma once

#include "integrate/runge_kutta/tableau.hpp"

namespace pendcore {

struct Collocation {
  using Row = std::array<double, 3>;
  using Matrix = std::array<Row, 3>;
  static constexpr int degree = 4;  ///< the degree of the dense output

  MethodInfo info;
  Row c;
  Matrix a;
  double real, alpha, beta;
  Matrix transformation;                  ///< T
  Matrix inverse;                         ///< the inverse of T
  Matrix interpolant;                     ///< P, a row for each power
  std::array<double, degree> correction;  ///< K/K'(0), powers 1 to 4
};

}  // namespace pendcore
