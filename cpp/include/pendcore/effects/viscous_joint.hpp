/// \file
/// Viscous damping in a joint:
///
///     tau = -(b w + b2 w |w| + b3 w^3),   w = phid
///
/// Source: the linear term is Rayleigh's dissipation (Theory of Sound I, 81); the quadratic and
/// cubic terms are the next ones of an odd law. Power: -tau w is lost. Negative coefficients feed
/// energy into the motion, which may then blow up in finite time.
///
/// |w| has a corner at w = 0. Where b2 is not 0, the sign of w is the mode, +1 or -1.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct ViscousJoint {
  int joint = 0;               ///< counted from 1
  double damping = not_given;  ///< b, N m s/rad
  double damping2 = 0.0;       ///< b2, N m s^2/rad^2
  double damping3 = 0.0;       ///< b3, N m s^3/rad^3

  static constexpr EffectInfo info{
      .name = "ViscousJoint",
      .kind = "viscous_joint",
      .sentence = "Viscous damping in a joint, with a linear, a quadratic and a cubic term.",
      .law = "tau = -(b w + b2 w abs(w) + b3 w^3),  w = phid",
      .source = "Rayleigh, The Theory of Sound I (1877), section 81, for the linear term",
      .account = Account::viscous,
      .damps_small_motions = true,
      .examples = "ViscousJoint(joint=2, damping=0.05)",
      .outcome = "viscous: 0.504 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&ViscousJoint::joint, joint_number),
      parameter(&ViscousJoint::damping,
                {.name = "damping",
                 .symbol = "b",
                 .unit = "N m s/rad",
                 .sentence = "linear coefficient; a negative one feeds energy into the motion",
                 .required = true}),
      parameter(&ViscousJoint::damping2, {.name = "damping2",
                                          .symbol = "b2",
                                          .unit = "N m s^2/rad^2",
                                          .sentence = "quadratic coefficient"}),
      parameter(&ViscousJoint::damping3, {.name = "damping3",
                                          .symbol = "b3",
                                          .unit = "N m s^3/rad^3",
                                          .sentence = "cubic coefficient"}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(ViscousJoint given);

}  // namespace pendcore
