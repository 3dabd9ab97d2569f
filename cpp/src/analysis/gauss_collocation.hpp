/// \file
/// A polynomial that takes given values at the points of a Gauss quadrature of a step, and its
/// integrals. Integrated so, linear equations have order 2 s at the end of a step.
///
/// Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.7.
#pragma once

#include <vector>

#include "pendcore/vector.hpp"

namespace pendcore {

/// The s points of a step from theta = 0 to 1.
struct GaussCollocation {
  explicit GaussCollocation(int points);

  /// With them, a row of the values of f at the points, (s), gives the integral of f from 0 to
  /// theta, and the integral of that.
  struct Integrals {
    Vector once, twice;
  };
  Integrals integrals(double theta) const;

  int s;
  Vector theta, weight;
  Matrix to_legendre;  ///< from values at the points to the coefficients of P_k, (s, s)
  std::vector<Integrals> to_point;
  Integrals to_end;
};

inline constexpr int least_points = 4;
inline constexpr int most_points = 16;

/// The one with so many points.
const GaussCollocation& gauss_collocation(int points);

}  // namespace pendcore
