/// \file
/// A stop at either end of the range of a joint:
///
///     lo <= phi <= hi;   at an impact phid+ = -e phid-, by an impulse in the joint
///
/// Below the capture speed the joint stays at the stop (e = 0). The stop holds it there until the
/// holding torque would have to pull. An impact on one stop loses (1 - e^2) phid^2 /
/// (2 J M^-1 J^T). Impacts on several stops at once obey the same law, with impulses that only
/// push. Source: Brogliato, Nonsmooth Mechanics (2016), sections 4.1 (Newton's law of restitution)
/// and 5.2 (several contacts).
#pragma once

#include "pendcore/effects/effect.hpp"

namespace pendcore {

struct JointStop {
  int joint = 0;                                         ///< counted from 1
  std::array<double, 2> range = {not_given, not_given};  ///< lo, hi, rad; +-never: no stop there
  double restitution = 0.0;                              ///< e, 0 to 1
  std::optional<double> capture_speed = {};  ///< rad/s; 1e-9 of a natural speed unless given

  static constexpr EffectInfo info{
      .name = "JointStop",
      .kind = "joint_stop",
      .sentence = "Stops at the ends of the range of a joint, with restitution.",
      .law = "lo <= phi <= hi;  phid+ = -e phid- at an impact, 0 below the capture speed",
      .source = "Brogliato, Nonsmooth Mechanics (2016), sections 4.1 and 5.2",
      .account = Account::impact,
      .bounds_joint = true,
      .jumps_or_sticks = true,
      .has_series = true,
      .examples =
          "JointStop(joint=2, range=(-0.5, 0.8), restitution=0.4)\n"
          "JointStop(joint=1, range=(0.0, inf), restitution=0.8, capture_speed=0.001)",
      .outcome = "impact: 0.563 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&JointStop::joint, joint_number),
      parameter(&JointStop::range, {.name = "range",
                                    .symbol = "(lo, hi)",
                                    .unit = "rad",
                                    .sentence = "angles of the joint where the stops are",
                                    .range = Range::number,
                                    .required = true,
                                    .components = {"lower", "upper"}}),
      parameter(&JointStop::restitution, {.name = "restitution",
                                          .symbol = "e",
                                          .unit = "1",
                                          .sentence = "share of the speed that an impact leaves",
                                          .range = Range::share}),
      parameter(&JointStop::capture_speed,
                {.name = "capture_speed",
                 .symbol = "w_c",
                 .unit = "rad/s",
                 .sentence = "slower impacts do not bounce; if left out, it is 1e-9 of the "
                             "natural speed sqrt(torque / inertia) of the joint",
                 .range = Range::not_negative}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(JointStop given);

}  // namespace pendcore
