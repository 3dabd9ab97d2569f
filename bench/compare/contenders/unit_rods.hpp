// The rates of change of two or three rods of 1 kg and 1 m, for contenders without mechanics of
// their own: the closed form with its constants in place, as a reader of it would write it for
// speed. The elimination begins at the tip, so that the accelerations need one division.
// equations.py has the same in Python.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "solves.hpp"

namespace contenders {

inline constexpr double gravity = 9.807;

struct TwoRods {
  static constexpr std::size_t size = 4;
  void operator()(const double* y, double* f) const { rates(y, f, 0.0, 0.0); }

 protected:
  // tau_1 and tau_2 act in the joints: docs/reference/conventions.md has the signs,
  // Q_i = tau_i - tau_{i+1}.
  static void rates(const double* y, double* f, double tau1, double tau2) {
    const double d = y[0] - y[1], c = std::cos(d), s = std::sin(d);
    const double r1 = 1.5 * gravity * std::cos(y[0]) - 0.5 * s * (y[3] * y[3]) + (tau1 - tau2);
    const double r2 = 0.5 * gravity * std::cos(y[1]) + 0.5 * s * (y[2] * y[2]) + tau2;
    const double a1 = (4.0 / 3 * r1 - 2 * (c * r2)) / (16.0 / 9 - c * c);
    f[0] = y[2];
    f[1] = y[3];
    f[2] = a1;
    f[3] = 3 * r2 - 1.5 * (c * a1);
  }
};

// The same rods with springs and dampers in the joints.
struct LoadedRods : TwoRods {
  double b1, b2, k1, k2, rest1, rest2;
  explicit LoadedRods(const Given& given)
      : b1(given["damping"][0]),
        b2(given["damping"][1]),
        k1(given["stiffness"][0]),
        k2(given["stiffness"][1]),
        rest1(given["rest"][0]),
        rest2(given["rest"][1]) {}
  void operator()(const double* y, double* f) const {
    rates(y, f, -k1 * (y[0] - rest1) - b1 * y[2], -k2 * (y[1] - y[0] - rest2) - b2 * (y[3] - y[2]));
  }
  // The derivatives of the rates by y_j in columns[j]: from M a = r(q, w), M da = dr - dM a.
  void jacobian(const double* y, double* const columns[4]) const {
    double f[4];
    (*this)(y, f);
    const double d = y[0] - y[1], c = 0.5 * std::cos(d), s = 0.5 * std::sin(d);
    const double share = 1 / (4.0 / 9 - c * c), v1 = y[2] * y[2], v2 = y[3] * y[3];
    const double first[4] = {-1.5 * gravity * std::sin(y[0]) - c * v2 - k2 - k1 + s * f[3],
                             c * v2 + k2 - s * f[3], -b2 - b1, b2 - 2 * s * y[3]};
    const double second[4] = {c * v1 + k2 + s * f[2],
                              -0.5 * gravity * std::sin(y[1]) - c * v1 - k2 - s * f[2],
                              b2 + 2 * s * y[2], -b2};
    for (std::size_t j = 0; j < 4; ++j) {
      columns[j][0] = j == 2;
      columns[j][1] = j == 3;
      columns[j][2] = (first[j] / 3 - c * second[j]) * share;
      columns[j][3] = (4.0 / 3 * second[j] - c * first[j]) * share;
    }
  }
};

struct ThreeRods {
  static constexpr std::size_t size = 6;
  void operator()(const double* y, double* f) const {
    const double d12 = y[0] - y[1], d13 = y[0] - y[2], d23 = y[1] - y[2];
    const double c12 = std::cos(d12), c13 = std::cos(d13), c23 = std::cos(d23);
    const double s12 = std::sin(d12), s13 = std::sin(d13), s23 = std::sin(d23);
    const double v1 = y[3] * y[3], v2 = y[4] * y[4], v3 = y[5] * y[5];
    const double r1 = 2.5 * gravity * std::cos(y[0]) - 1.5 * (s12 * v2) - 0.5 * (s13 * v3);
    const double r2 = 1.5 * gravity * std::cos(y[1]) + 1.5 * (s12 * v1) - 0.5 * (s23 * v3);
    const double r3 = 0.5 * gravity * std::cos(y[2]) + 0.5 * (s13 * v1) + 0.5 * (s23 * v2);
    const double m11 = 7.0 / 3 - 0.75 * (c13 * c13), m22 = 4.0 / 3 - 0.75 * (c23 * c23);
    const double m12 = 1.5 * c12 - 0.75 * (c13 * c23);
    const double p1 = r1 - 1.5 * (c13 * r3), p2 = r2 - 1.5 * (c23 * r3);
    const double share = 1 / (m11 * m22 - m12 * m12);
    const double a1 = (m22 * p1 - m12 * p2) * share, a2 = (m11 * p2 - m12 * p1) * share;
    std::copy_n(y + 3, 3, f);
    f[3] = a1;
    f[4] = a2;
    f[5] = 3 * r3 - 1.5 * (c13 * a1 + c23 * a2);
  }
};

// Calls `make` with the rods of the case.
template <class Make>
auto with_rods(const Given& given, Make make) {
  const auto all = [&given](const char* name, double value) {
    return std::ranges::all_of(given[name], [value](double number) { return number == value; });
  };
  const bool unit = all("masses", 1.0) && all("lengths", 1.0) && all("gravity", gravity);
  const bool bare = all("damping", 0.0) && all("stiffness", 0.0);
  if (unit && given.n() == 2) return bare ? make(TwoRods()) : make(LoadedRods(given));
  if (unit && bare && given.n() == 3) return make(ThreeRods());
  throw Unsupported(
      "its right-hand sides are written for two or three rods of 1 kg and 1 m, the joints of "
      "three without torque");
}

}  // namespace contenders
