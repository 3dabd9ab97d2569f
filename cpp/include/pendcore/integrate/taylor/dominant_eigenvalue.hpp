/// \file
/// How fast the fastest part of a direction is: with the Jacobian J of y' = f(t, y), y = (q, qd),
///
///     |lambda| = (|J J v| / |v|)^(1/2)      (1/s)
///
/// The high coefficients of a Taylor series are such a direction: each is J times the one before,
/// over its number, so that what is fastest outgrows the rest (power iteration). Twice J, as a pair
/// of conjugate eigenvalues turns v in its plane: J J v = -omega^2 v where nothing is damped.
///
/// J v is a central difference over a millionth of a radian: an estimate, of which two digits
/// count. Cost: four right-hand sides; no allocation.
#pragma once

#include <vector>

#include "pendcore/integrate/stepper.hpp"

namespace pendcore {

class DominantEigenvalue {
 public:
  static constexpr int evaluations = 4;

  /// The state has n angles, n rates and that many quadratures, which have no say.
  DominantEigenvalue(int n, int quadratures);

  /// The direction, 2n numbers, to be filled in: rad, rad/s.
  double* direction() { return v_.data(); }

  /// At time t (s) and state y; `rate` (1/s) says how many rad/s weigh as much as a radian. 0 of a
  /// direction that is none.
  double operator()(const Rates& rates, double t, const double* y, double rate);

 private:
  /// v becomes J v, divided by its own size; returns that.
  double multiply(const Rates& rates, double t, const double* y, double rate);
  double norm(double rate) const;

  int n_;
  std::vector<double> v_, state_, ahead_, behind_;
};

}  // namespace pendcore
