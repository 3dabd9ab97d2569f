/// \file
/// Dry friction in a joint while it slides, with Stribeck's effect:
///
///     tau = -(t_c + (t_s - t_c) exp(-|w/w_s|^p)) sgn w,   w = phid
///
/// Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, section 3.
/// Power: -tau w is lost. The sign of w is the mode; at a reversal the joint goes on sliding if the
/// torques on it exceed t_s, and comes to rest otherwise.
#pragma once

#include "pendcore/arithmetic/exponential.hpp"
#include "pendcore/effects/hooks.hpp"

namespace pendcore {

struct DryJointFriction {
  int joint = 0;
  double coulomb = 0.0;
  std::optional<double> static_ = {};  ///< equal to coulomb unless given
  double stribeck_velocity = 0.1;
  double exponent = 2.0;

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
  static constexpr Hooks hooks{.couple = true,
                               .law = true,
                               .group = true,
                               .modes = true,
                               .holding_torque = true,
                               .check = true};
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

  double peak() const { return static_.value_or(coulomb) - coulomb; }
  void check(const std::string& where) const {
    if (static_ && peak() < 0) {
      refuse(where + "static", *static_, "at least coulomb = " + text(coulomb) + " (N m)");
    }
  }

  /// The torque of Coulomb's law, if there is no static peak. With a peak, Law has the torque.
  std::optional<Couple> couple(int mode) const {
    if (peak() > 0) return std::nullopt;
    return Couple{.held = -mode * coulomb};
  }

  template <class Row>
  struct Law {
    Row coulomb{};  // has the sign of w, as the next two have
    Row peak{};
    Row inverse_velocity{};
    double exponent = 2.0;

    template <class At, class Loads>
    PENDCORE_INLINE void add(const At& at, Loads& loads) const {
      using V = typename At::Value;
      const V x = absolute(at.phid() * Constants<V>::of(inverse_velocity));
      const V share = exponential(-power(x, exponent));
      loads.couple(-fma(Constants<V>::of(peak), share, Constants<V>::of(coulomb)));
    }
  };

  /// Joints of one row share a law only if they have the same exponent.
  double group() const { return exponent; }

  template <class Row>
  void put(Law<Row>& law, int /*lane*/, const LinkConstants& /*on*/) const {
    law.exponent = exponent;
  }

  bool has_modes() const { return true; }
  int mode_at(double /*t*/, double /*phi*/, double phid, bool /*forward*/) const {
    return phid < 0.0 ? -1 : 1;
  }
  std::vector<Guard> guards(int mode) const { return {{.on_phid = static_cast<double>(mode)}}; }
  int next_mode(int mode, std::size_t /*guard*/) const { return -mode; }
  template <class Row>
  void put_mode(Law<Row>& law, int lane, int mode) const {
    set_lane(law.coulomb, lane, mode * coulomb);
    set_lane(law.peak, lane, mode * peak());
    set_lane(law.inverse_velocity, lane, mode / stribeck_velocity);
  }

  /// The largest torque with which the friction holds the joint at rest, N m.
  double holding_torque() const { return static_.value_or(coulomb); }
};

}  // namespace pendcore
