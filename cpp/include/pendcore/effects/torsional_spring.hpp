/// \file
/// A torsional spring in a joint:
///
///     tau = -k (phi - phi_0),   V = k (phi - phi_0)^2 / 2
///
/// Source: Hooke's law. Its energy is part of the potential energy.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct TorsionalSpring {
  int joint = 0;                 ///< counted from 1
  double stiffness = not_given;  ///< k, N m/rad
  double rest_angle = 0.0;       ///< phi_0, rad

  static constexpr EffectInfo info{
      .name = "TorsionalSpring",
      .kind = "torsional_spring",
      .sentence = "A linear torsional spring in a joint.",
      .law = "tau = -k (phi - phi_0),  V = k (phi - phi_0)^2 / 2",
      .source = "Hooke's law",
      .examples = "TorsionalSpring(joint=2, stiffness=30.0, rest_angle=0.5)",
      .outcome = "q at 1 s: [2.239, 2.77] rad"};
  static constexpr auto parameters = std::tuple{
      parameter(&TorsionalSpring::joint, joint_number),
      parameter(&TorsionalSpring::stiffness,
                {.name = "stiffness",
                 .symbol = "k",
                 .unit = "N m/rad",
                 .sentence = "torque per angle; a negative one pushes away from the rest angle",
                 .required = true}),
      parameter(&TorsionalSpring::rest_angle,
                {.name = "rest_angle",
                 .symbol = "phi_0",
                 .unit = "rad",
                 .sentence = "angle of the joint at which the torque is zero"}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(TorsionalSpring given);

}  // namespace pendcore
