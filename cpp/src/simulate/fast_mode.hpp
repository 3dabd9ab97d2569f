/// \file
/// Which mode of a scene is so fast that it sets the steps.
///
/// The modes are those of the equations linearised about one state, of the eigenvalues lambda of
/// ((0, 1), (A, B)) with the exact A and B of dynamics/jacobian.hpp. A pair of them, conjugate or
/// both real, is a mode of frequency omega and damping ratio zeta:
///
///     lambda_1 lambda_2 = omega^2,   lambda_1 + lambda_2 = -2 zeta omega
///
/// Cost: the derivatives of the scene and of it without each of its effects; where a bound does not
/// rule a fast mode out, an eigenvalue problem of size 2n. After a run, not in it.
#pragma once

#include <optional>

#include "dynamics/equations_of_motion.hpp"

namespace pendcore {

struct FastMode {
  double frequency;           ///< omega, rad/s
  double damping_ratio;       ///< zeta
  double fastest;             ///< the larger |lambda| of the two, 1/s
  int joint;                  ///< that moves most, from 1
  std::optional<int> effect;  ///< without which the scene is slowest, from 0
};

/// The fastest mode about a state (n angles, rad, and rates, rad/s) at a time (s), in the modes of
/// the effects that are in force, if it is 30 times faster than any of the links without effects.
std::optional<FastMode> fast_mode(const Scene& scene, const EquationsOfMotion& equations, double t,
                                  const double* q, const double* qd);

}  // namespace pendcore
