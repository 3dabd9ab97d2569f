/// \file
/// A motor in a joint: a torque of one of four laws, clipped at +-limit,
///
///     constant    tau = value
///     sinusoid    tau = A sin(omega t + phase)
///     table       tau linear between given points, or held; the run ends where the table does
///     pd          tau = kp (reference - phi) - kd w
///
/// Power: tau w. The modes of a table are its pieces, each between two points. A sinusoid and a PD
/// controller are free or clipped. The times at which a sinusoid is clipped are known in advance:
/// omega t + phase = k pi +- asin(limit/|A|).
#pragma once

#include "pendcore/effects/effect.hpp"
#include "pendcore/effects/function_of_time.hpp"

namespace pendcore {

struct Motor {
  int joint = 0;                          ///< counted from 1
  std::optional<double> constant = {};    ///< N m; one of these four is given
  std::optional<Sinusoid> sinusoid = {};  ///< N m
  std::optional<Table> table = {};        ///< N m
  std::optional<PD> pd = {};              ///< N m
  double limit = never;                   ///< N m, the largest torque in either direction

  static constexpr EffectInfo info{
      .name = "Motor",
      .kind = "motor",
      .sentence = "A motor in a joint: constant torque, sinusoid, table or PD controller.",
      .law =
          "tau = constant | A sin(omega t + psi) | linear between points, or held | "
          "k_p (phi_r - phi) - k_d w,  clipped at +-limit",
      .source =
          "Spong, Hutchinson, Vidyasagar, Robot Modeling and Control (2006), section 6.3, "
          "for PD control",
      .account = Account::motor,
      .examples =
          "Motor(joint=1, constant=2.0)\n"
          "Motor(joint=1, sinusoid=Sinusoid(amplitude=3.0, angular_frequency=6.0))\n"
          "Motor(joint=2, table=Table(t=(0.0, 0.5, 2.0), torque=(0.0, 1.5, -1.5)))\n"
          "Motor(joint=2, table=Table(t=(0.0, 0.5, 2.0), torque=(1.5, -1.5, 0.0), hold=True))\n"
          "Motor(joint=2, pd=PD(kp=40.0, kd=2.0, reference=0.3), limit=8.0)",
      .outcome = "motor: 3.625 J"};
  static constexpr auto parameters = std::tuple{
      parameter(&Motor::joint, joint_number),
      parameter(
          &Motor::constant,
          {.name = "constant", .symbol = "tau", .unit = "N m", .sentence = "a constant torque"}),
      parameter(&Motor::sinusoid,
                {.name = "sinusoid", .unit = "N m", .sentence = "a sinusoidal torque"}),
      parameter(&Motor::table,
                {.name = "table", .unit = "N m", .sentence = "a torque given at points in time"}),
      parameter(&Motor::pd, {.name = "pd",
                             .unit = "N m",
                             .sentence = "a controller that holds the joint at an angle"}),
      parameter(&Motor::limit, {.name = "limit",
                                .unit = "N m",
                                .sentence = "largest torque in either direction",
                                .range = Range::positive_or_infinite}),
  };
};

std::shared_ptr<const EffectBehaviour> behaviour(Motor given);

}  // namespace pendcore
