/// \file
/// A pivot that is moved along a given path (x_0(t), y_0(t)): the equations hold in its frame with
///
///     g -> (-xdd_0, g - ydd_0)
///
/// for gravity. The path is a sinusoid for each axis or a natural cubic spline through points; its
/// velocity and acceleration are the exact derivatives. Source: d'Alembert's principle. The drive
/// of the pivot has the power F_01 . v_0.
#pragma once

#include "pendcore/effects/effect.hpp"
#include "pendcore/effects/function_of_time.hpp"

namespace pendcore {

struct DrivenPivot {
  std::optional<Sinusoid> x = {};     ///< m, to the right
  std::optional<Sinusoid> y = {};     ///< m, downward
  std::optional<Spline> spline = {};  ///< m, along both axes, in place of the two

  static constexpr EffectInfo info{
      .name = "DrivenPivot",
      .kind = "driven_pivot",
      .sentence = "A pivot that is moved: a sinusoid for each axis, or a spline.",
      .law = "x_0 = A_x sin(omega_x t + psi_x),  y_0 likewise;  or natural cubic splines",
      .source = "d'Alembert's principle",
      .account = Account::drive,
      .depends_on_time = true,
      .moves_pivot = true,
      .has_series = true,
      .examples =
          "DrivenPivot(y=Sinusoid(amplitude=0.02, angular_frequency=90.0))\n"
          "DrivenPivot(spline=Spline(t=(0.0, 1.0, 2.0), x=(0.0, 0.3, 0.0), y=(0.0, 0.0, 0.1)))",
      .outcome = "drive: -0.484 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&DrivenPivot::x,
                {.name = "x", .symbol = "x_0", .unit = "m", .sentence = "motion to the right"}),
      parameter(&DrivenPivot::y,
                {.name = "y", .symbol = "y_0", .unit = "m", .sentence = "motion downward"}),
      parameter(&DrivenPivot::spline, {.name = "spline",
                                       .unit = "m",
                                       .sentence = "motion along both axes, through given points"}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(DrivenPivot given);

}  // namespace pendcore
