/// \file
/// The laws of time that motors and pivots follow: a sinusoid, a table, a natural cubic spline.
///
///     sinusoid  amplitude sin(angular_frequency t + phase)
///     Table     linear between its points, or held from each point to the next
///     Spline    natural cubic through its points: x'' is linear between them, 0 at both ends
///
/// A table and a spline end where their points end. Beyond, they have no value (NaN), and a run
/// ends there. Between two points they are a polynomial in the time since the first of the two.
#pragma once

#include <string>
#include <vector>

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct Sinusoid {
  double amplitude = not_given;          ///< A, in the unit of what it drives: N m or m
  double angular_frequency = not_given;  ///< omega, rad/s
  double phase = 0.0;                    ///< phi, rad

  static constexpr std::string_view name = "Sinusoid";
  static constexpr std::string_view sentence =
      "amplitude sin(angular_frequency t + phase); the amplitude has the unit of what it drives.";
  static constexpr auto parameters = std::tuple{
      parameter(&Sinusoid::amplitude, {.name = "amplitude",
                                       .symbol = "A",
                                       .unit = "N m or m",
                                       .sentence = "largest value",
                                       .required = true}),
      parameter(&Sinusoid::angular_frequency, {.name = "angular_frequency",
                                               .symbol = "omega",
                                               .unit = "rad/s",
                                               .sentence = "2 pi over the period",
                                               .required = true}),
      parameter(&Sinusoid::phase,
                {.name = "phase", .symbol = "psi", .unit = "rad", .sentence = "phase at t = 0"}),
  };
};

/// The value is value + slope (t - t_k) from t_k to t_{k+1}; the slope is 0 if values are held. Two
/// equal times make a step: the first has the value before it, the second the value after it.
struct Table {
  std::vector<double> t = {};       ///< s, increasing
  std::vector<double> torque = {};  ///< N m, one for each time
  bool hold = false;                ///< whether each torque holds until the next time

  static constexpr std::string_view name = "Table";
  static constexpr std::string_view sentence =
      "Torque at given times, linear between them or held; the run ends where the table ends.";
  static constexpr auto parameters = std::tuple{
      parameter(&Table::t, {.name = "t",
                            .symbol = "t",
                            .unit = "s",
                            .sentence = "times, increasing, two or more; where the torque steps, "
                                        "the time stands twice",
                            .required = true}),
      parameter(&Table::torque, {.name = "torque",
                                 .symbol = "tau",
                                 .unit = "N m",
                                 .sentence = "torque at those times",
                                 .required = true}),
      parameter(&Table::hold, {.name = "hold",
                               .sentence = "whether each torque holds until the next time, the "
                                           "last one for no time"}),
  };
  void check(const std::string& where) const;
};

/// A controller that holds a joint at an angle: kp (reference - phi) - kd w.
struct PD {
  double kp = not_given;         ///< N m/rad
  double kd = not_given;         ///< N m s/rad
  double reference = not_given;  ///< rad

  static constexpr std::string_view name = "PD";
  static constexpr std::string_view sentence =
      "A controller that holds the joint at an angle: kp (reference - phi) - kd w.";
  static constexpr auto parameters = std::tuple{
      parameter(&PD::kp, {.name = "kp",
                          .symbol = "k_p",
                          .unit = "N m/rad",
                          .sentence = "proportional gain",
                          .required = true}),
      parameter(&PD::kd, {.name = "kd",
                          .symbol = "k_d",
                          .unit = "N m s/rad",
                          .sentence = "derivative gain",
                          .required = true}),
      parameter(&PD::reference, {.name = "reference",
                                 .symbol = "phi_r",
                                 .unit = "rad",
                                 .sentence = "target angle of the joint",
                                 .required = true}),
  };
};

/// Natural cubic splines x(t) and y(t).
struct Spline {
  std::vector<double> t = {};  ///< s, increasing
  std::vector<double> x = {};  ///< m, to the right, one for each time
  std::vector<double> y = {};  ///< m, downward, one for each time

  static constexpr std::string_view name = "Spline";
  static constexpr std::string_view sentence =
      "Natural cubic splines x(t) and y(t) through given points; the run ends where they end.";
  static constexpr auto parameters = std::tuple{
      parameter(&Spline::t, {.name = "t",
                             .symbol = "t",
                             .unit = "s",
                             .sentence = "times, increasing, two or more",
                             .required = true}),
      parameter(&Spline::x, {.name = "x",
                             .symbol = "x_0",
                             .unit = "m",
                             .sentence = "position to the right at those times",
                             .required = true}),
      parameter(&Spline::y, {.name = "y",
                             .symbol = "y_0",
                             .unit = "m",
                             .sentence = "position downward at those times",
                             .required = true}),
  };
  void check(const std::string& where) const;

  /// The second derivatives at the points, for the values of x or of y; none if the counts differ.
  std::vector<double> second_derivatives(const std::vector<double>& values) const;
};

}  // namespace pendcore
