/// \file
/// A rigid body at the tip of the chain, fixed to the last link:
///
///     S_i += m_p,   A_nn += m_p L_n^2 + I_p
///
/// Source: the parallel axis theorem. The payload only changes constants of the equations and of
/// the energy.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct Payload {
  double mass = not_given;  ///< m_p, kg
  double inertia = 0.0;     ///< I_p, kg m^2, about its mass centre, which is at the tip

  static constexpr EffectInfo info{.name = "Payload",
                                   .kind = "payload",
                                   .sentence = "A rigid body at the tip, fixed to the last link.",
                                   .law = "S_i += m_p,  A_nn += m_p L_n^2 + I_p",
                                   .source = "the parallel axis theorem",
                                   .has_series = true,
                                   .examples = "Payload(mass=0.5, inertia=0.001)",
                                   .outcome = "q at 1 s: [2.007, 2.612] rad"};
  static constexpr auto parameters = std::tuple{
      parameter(&Payload::mass, {.name = "mass",
                                 .symbol = "m_p",
                                 .unit = "kg",
                                 .sentence = "mass of the body",
                                 .range = Range::not_negative,
                                 .required = true}),
      parameter(&Payload::inertia,
                {.name = "inertia",
                 .symbol = "I_p",
                 .unit = "kg m^2",
                 .sentence = "moment of inertia about its mass centre, which is at the tip",
                 .range = Range::not_negative}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(Payload given);

}  // namespace pendcore
