/// \file
/// A joint that is locked:
///
///     phi_j = constant,   phid_j = phidd_j = 0
///
/// The joint is eliminated from the equations. Its angle and rate are set anew at the end of each
/// step, so that rounding does not make them drift. A lock does no work.
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct Lock {
  int joint = 0;                     ///< counted from 1
  std::optional<double> angle = {};  ///< rad; the angle at the start, unless given

  static constexpr EffectInfo info{
      .name = "Lock",
      .kind = "lock",
      .sentence =
          "A joint locked at an angle: one degree of freedom less. It may join massless "
          "links.",
      .law = "phi = constant",
      .source = "the textbook's mobility, 3 n - 2 c5 - c4, with two links made one",
      .bounds_joint = true,
      .has_series = true,
      .examples =
          "Lock(joint=2)\n"
          "Lock(joint=2, angle=0.5)",
      .outcome = "q at 1 s: [2.26, 2.76] rad"};
  static constexpr auto parameters = std::tuple{
      parameter(&Lock::joint, joint_number),
      parameter(&Lock::angle,
                {.name = "angle",
                 .symbol = "phi",
                 .unit = "rad",
                 .sentence = "angle of the joint, at which a run must start; its angle there if "
                             "left out"}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(Lock given);

}  // namespace pendcore
