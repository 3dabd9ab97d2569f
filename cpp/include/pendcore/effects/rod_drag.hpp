/// \file
/// Air drag along a link, a slender rod across the flow:
///
///     f(s) = -k |w(s)| w(s) n,   k = rho C_d d / 2
///
/// The loss of the rod is the integral of k |w|^3; the rest of the drag's power is the wind's.
/// Source: the cross-flow principle, Hoerner, Fluid-Dynamic Drag (1965), chapter 3.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct RodDrag {
  int link = 0;                             ///< counted from 1
  double drag_coefficient = not_given;      ///< C_d, without a unit
  double diameter = not_given;              ///< d, m
  double air_density = 1.225;               ///< rho, kg/m^3
  std::array<double, 2> wind = {0.0, 0.0};  ///< m/s, x right and y down

  double k() const { return 0.5 * air_density * drag_coefficient * diameter; }  ///< kg/m^2

  static constexpr EffectInfo info{
      .name = "RodDrag",
      .kind = "rod_drag",
      .sentence = "Air drag on a link, along the whole rod, quadratic in the speed across it.",
      .law =
          "f(s) = -k abs(w) w,  k = rho C_d d / 2,  w(s) is the speed across the rod relative to "
          "the air",
      .source = "Hoerner, Fluid-Dynamic Drag (1965), chapter 3, the cross-flow principle",
      .account = Account::drag,
      .examples = "RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0))",
      .outcome = "drag: 3.696 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&RodDrag::link, link_number),
      parameter(&RodDrag::drag_coefficient,
                {.name = "drag_coefficient",
                 .symbol = "C_d",
                 .unit = "1",
                 .sentence = "drag coefficient of the cross-section, about 1.2 for a round rod",
                 .range = Range::not_negative,
                 .required = true}),
      parameter(&RodDrag::diameter, {.name = "diameter",
                                     .symbol = "d",
                                     .unit = "m",
                                     .sentence = "width of the rod across the flow",
                                     .range = Range::not_negative,
                                     .required = true}),
      parameter(&RodDrag::air_density, {.name = "air_density",
                                        .symbol = "rho",
                                        .unit = "kg/m^3",
                                        .sentence = "density of the air or another fluid",
                                        .range = Range::not_negative}),
      parameter(
          &RodDrag::wind,
          {.name = "wind", .unit = "m/s", .sentence = "velocity of the air, x right and y down"}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(RodDrag given);

}  // namespace pendcore
