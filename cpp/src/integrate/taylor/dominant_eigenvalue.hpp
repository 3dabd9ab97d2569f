/// \file
/// The rate of the fastest part of a direction v: with the Jacobian J of y' = f(t, y), y = (q, qd),
///
///     |lambda| = (|J J v| / |v|)^(1/2)      (1/s)
///
/// The high coefficients of a Taylor series are good directions: each is J times the coefficient
/// before, divided by its order, so that the fastest part outgrows the rest (power iteration). J is
/// applied twice because a pair of conjugate eigenvalues turns v in its plane: J J v = -omega^2 v
/// without damping.
///
/// J v is a central difference over a millionth of a radian, which is good enough for an estimate
/// of two digits. Cost: four right-hand sides.
#pragma once

#include <vector>

#include "integrate/stepper.hpp"

namespace pendcore {

class DominantEigenvalue {
 public:
  static constexpr int evaluations = 4;

  /// The state has n angles, n rates and some quadratures, which are left out of account.
  DominantEigenvalue(int n, int quadratures) : n_(n), quadratures_(quadratures) {}

  /// Memory for the direction, 2n numbers (rad, rad/s), which the caller writes before each
  /// computation. The first call allocates it: few runs come to ask for an eigenvalue.
  double* direction();

  /// Computes |lambda| at time t (s) and state y; `rate` (1/s) says how many rad/s weigh as much as
  /// a radian. Returns 0 if the direction is zero or not finite.
  double operator()(const Rates& rates, double t, const double* y, double rate);

 private:
  /// Replaces v by J v divided by its size, and returns that size.
  double multiply(const Rates& rates, double t, const double* y, double rate);
  double norm(double rate) const;

  int n_, quadratures_;
  std::vector<double> v_, state_, ahead_, behind_;
};

/// h |lambda| over the order of the series, for a step of size h from the state y at time t;
/// `eigenvalue` has the last coefficient of the series there as its direction.
double stiffness_of_series(DominantEigenvalue& eigenvalue, const Rates& rates, double t,
                           const double* y, double h, int order);

}  // namespace pendcore
