/// \file
/// Dry friction in a joint while it slides, with Stribeck's effect:
///
///     tau = -(t_c + (t_s - t_c) exp(-|w/w_s|^p)) sgn w,   w = phid
///
/// Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 3.
/// Power: -tau w is lost. The sign of w is the mode; at a reversal the joint goes on sliding if the
/// torques on it exceed t_s, and comes to rest otherwise.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct DryJointFriction {
  int joint = 0;                       ///< counted from 1
  double coulomb = not_given;          ///< t_c, N m, while it slides
  std::optional<double> static_ = {};  ///< t_s, N m, holds it; equal to coulomb unless given
  double stribeck_velocity = 0.1;      ///< w_s, rad/s
  double exponent = 2.0;               ///< p, without a unit

  static constexpr EffectInfo info{
      .name = "DryJointFriction",
      .kind = "dry_joint_friction",
      .sentence = "Dry friction in a joint, Coulomb's with a static peak (Stribeck).",
      .law = "tau = -(t_c + (t_s - t_c) exp(-abs(w/w_s)^p)) sgn w,  w = phid",
      .source = "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 3",
      .account = Account::dry,
      .jumps_or_sticks = true,
      .examples = "DryJointFriction(joint=1, coulomb=0.2, static=0.3, stribeck_velocity=0.05)",
      .outcome = "dry: 0.323 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&DryJointFriction::joint, joint_number),
      parameter(&DryJointFriction::coulomb, {.name = "coulomb",
                                             .symbol = "t_c",
                                             .unit = "N m",
                                             .sentence = "torque of sliding friction",
                                             .range = Range::not_negative,
                                             .required = true}),
      parameter(&DryJointFriction::static_,
                {.name = "static",
                 .symbol = "t_s",
                 .unit = "N m",
                 .sentence = "largest torque that holds the joint, at least coulomb; equal to "
                             "coulomb if left out",
                 .range = Range::not_negative}),
      parameter(&DryJointFriction::stribeck_velocity,
                {.name = "stribeck_velocity",
                 .symbol = "w_s",
                 .unit = "rad/s",
                 .sentence = "rate over which static friction gives way to sliding friction",
                 .range = Range::positive}),
      parameter(&DryJointFriction::exponent, {.name = "exponent",
                                              .symbol = "p",
                                              .unit = "1",
                                              .sentence = "shape of that transition",
                                              .range = Range::at_least_one}),
  };

  /// What the static torque is above the sliding one, N m.
  double peak() const { return static_.value_or(coulomb) - coulomb; }
};

std::shared_ptr<const EffectBehaviour> behaviour(DryJointFriction given);

}  // namespace pendcore
