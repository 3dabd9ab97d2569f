/// \file
/// The inertia of a rotor in a joint, such as the inertia of a geared motor as seen from its
/// output:
///
///     T += J phid^2 / 2:   M_jj += J,  M_{j-1,j-1} += J,  M_{j,j-1} -= J
///
/// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), section 9.6. The rotor only changes
/// constants of the mass matrix.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct RotorInertia {
  int joint = 0;                ///< counted from 1
  double armature = not_given;  ///< J, kg m^2, as the joint feels it

  static constexpr EffectInfo info{
      .name = "RotorInertia",
      .kind = "rotor_inertia",
      .sentence = "The inertia of a rotor that turns with a joint.",
      .law = "T += J phid^2 / 2",
      .source = "Featherstone, Rigid Body Dynamics Algorithms (2008), section 9.6",
      .has_series = true,
      .examples = "RotorInertia(joint=1, armature=0.02)",
      .outcome = "q at 1 s: [2.128, 2.936] rad"};
  static constexpr auto parameters = std::tuple{
      parameter(&RotorInertia::joint, joint_number),
      parameter(&RotorInertia::armature, {.name = "armature",
                                          .symbol = "J",
                                          .unit = "kg m^2",
                                          .sentence = "moment of inertia as the joint feels it",
                                          .range = Range::not_negative,
                                          .required = true}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(RotorInertia given);

}  // namespace pendcore
