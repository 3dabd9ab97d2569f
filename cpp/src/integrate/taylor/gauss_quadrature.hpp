/// \file
/// The integral of a function along a step, from its values at eight points within:
///
///     y(theta) = h integral of f from 0 to theta,    f(theta) = sum_k p_k P_k(2 theta - 1)
///     p_k = (2 k + 1) sum_j w_j f(theta_j) P_k(2 theta_j - 1),   k < 8
///
/// with Legendre's polynomials P_k. It is of order 16 at theta = 1, and of order 8 in between. It
/// is for quantities that are only integrated along a step whose own polynomial is of high order.
///
/// Source: Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 25.4.29 and 22.3.8.
#pragma once

#include <array>

namespace pendcore {

struct GaussQuadrature {
  static constexpr int points = 8;
  static constexpr std::array<double, points> theta = {
      0.019855071751231884158, 0.1016667612931866302,  0.23723379504183550709,
      0.40828267875217509753,  0.59171732124782490247, 0.76276620495816449291,
      0.8983332387068133698,   0.98014492824876811584};
  static constexpr std::array<double, points> weight = {
      0.050614268145188129576, 0.11119051722668723527, 0.15685332293894364367,
      0.18134189168918099148,  0.18134189168918099148, 0.15685332293894364367,
      0.11119051722668723527,  0.050614268145188129576};

  /// The integral over the whole step, of length 1, from the values at the points.
  static double whole(const double* values) {
    double sum = 0.0;
    for (int j = 0; j < points; ++j) sum += weight[j] * values[j];
    return sum;
  }

  /// The integral up to theta as a polynomial: the coefficients of theta, ... theta^8.
  static std::array<double, points> powers(const double* values) {
    std::array<double, points> result{};
    for (int k = 0; k < points; ++k) {
      double p = 0.0;
      for (int j = 0; j < points; ++j) p += weight[j] * values[j] * legendre(k, theta[j]);
      p *= 2 * k + 1;
      double coefficient = k % 2 == 0 ? 1.0 : -1.0;  // factor of theta^i in P_k(2 theta - 1)
      for (int i = 0; i <= k; ++i) {
        result[i] += p * coefficient / (i + 1);
        coefficient *= -static_cast<double>((k + i + 1) * (k - i)) / ((i + 1) * (i + 1));
      }
    }
    return result;
  }

 private:
  /// P_k(2 theta - 1), by its recurrence.
  static constexpr double legendre(int k, double at) {
    const double x = 2.0 * at - 1.0;
    double before = 0.0;
    double here = 1.0;
    for (int i = 0; i < k; ++i) {
      const double next = ((2 * i + 1) * x * here - i * before) / (i + 1);
      before = here;
      here = next;
    }
    return here;
  }
};

}  // namespace pendcore
