/// \file
/// The angle of a joint, and likewise its rate and its acceleration: phi_j = q_j - q_{j-1}.
#pragma once

#include <cmath>

namespace pendcore {

/// The value of joint j, counted from 1: x_j - x_{j-1}.
inline double relative(const double* x, int joint) {
  return joint > 1 ? x[joint - 1] - x[joint - 2] : x[0];
}

/// The sizes of what is subtracted there, of which its rounding is a share.
inline double size_of_relative(const double* x, int joint) {
  return std::abs(x[joint - 1]) + (joint > 1 ? std::abs(x[joint - 2]) : 0.0);
}

/// Turns joint j, counted from 1, to x_j - x_{j-1} = value.
inline void set_relative(double* x, int joint, double value) {
  x[joint - 1] = joint > 1 ? x[joint - 2] + value : value;
}

}  // namespace pendcore
