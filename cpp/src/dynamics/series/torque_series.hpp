/// \file
/// The Taylor series of the torques of effects on the joints of a few links. The effects are
/// couples (effects/couples.hpp): polynomials of the time and of the angle and rate of a joint, and
/// up to two waves.
///
///     tau = held + slope (t - start) + on_phi phi + on_phid w + on_phid2 w^2 + on_phid3 w^3
///           + gain sin(omega t + phase)
///
/// Time is in units of sigma, and the result is the torque on each link, times sigma^2 and a factor
/// of each link. Squares and cubes of the rate are sums of products. Each order of a wave follows
/// from the order before,
///
///     s_{k+1} = omega sigma c_k/(k + 1),    c_{k+1} = -omega sigma s_k/(k + 1)
///
/// Cost: for each order some 10 operations, 5 more for each wave, and k products for each square or
/// cube.
#pragma once

#include <memory>

#include "arithmetic/dual_rows.hpp"
#include "arithmetic/order_of_series.hpp"
#include "arithmetic/power.hpp"
#include "dynamics/effects_in_rows.hpp"

namespace pendcore {

/// No torque but gravity's, and its orders.
struct NoTorque {
  static constexpr bool is_there = false;
};

/// The laws of the torques on a row of links. `Number` is a double, or a pack with one trajectory a
/// lane.
template <class Links, class Number>
struct TorqueLaws {
  const Couples<Links>* couples = nullptr;      ///< of effects that outlive this; null without any
  int waves = 0;                                ///< at most two
  PairOf<Number> angular_frequency{}, phase{};  ///< of each wave, rad/s and rad
  Links gain[2]{};                              ///< what each wave gives to the joints, N m
  Links factor{};                               ///< multiplies the result
};

/// The laws of a scene that are in force now: a motor at its limit has no wave. `Effects` are
/// EffectsInRows, or EffectsInLanes with a trajectory in each lane.
template <class Effects, class Links = typename Effects::Row>
PENDCORE_INLINE TorqueLaws<Links, typename Effects::Number> torque_laws(const Effects& effects,
                                                                        const Links& factor) {
  using Number = typename Effects::Number;
  TorqueLaws<Links, Number> laws;
  laws.factor = factor;
  if (!effects.couples.empty()) laws.couples = &effects.couples.front();
  if (effects.waves == 0) return laws;
  laws.waves = effects.waves;
  laws.angular_frequency = effects.angular_frequency.pair(0);
  laws.phase = effects.phase.pair(0);
  for (const auto& one : effects.joint_waves) {
    Links& gain = laws.gain[one.wave];
    set_number(gain, one.joint, Number(number_of(gain, one.joint) + one.gain));
  }
  return laws;
}

/// The orders of one series of torques. `Links` may be dual, the constants of laws, `OfLinks`, too;
/// the time is not.
template <class Links, class Number, class OfLinks = ConstantOf<Links>>
class TorqueOrders {
  using Laws = TorqueLaws<OfLinks, Number>;
  using Waves = PairOf<Number>;
  using Time = ConstantOf<Number>;

 public:
  PENDCORE_INLINE TorqueOrders(const Laws& laws, const Time& t, const Time& sigma)
      : laws_(laws),
        sigma_(sigma),
        per_sigma_(inverse_of_power_of_two(sigma)),
        by_(sigma * sigma * laws.factor) {
    if (laws.couples != nullptr) {
      in_time_ = laws.couples->template in_time<OfLinks>(t);
      damping_ = per_sigma_ * laws.couples->on_phid;
    }
    if (laws.waves == 0) return;
    sine_cosine(fma(laws.angular_frequency, Constants<Waves>::of(t), laws.phase), sine_, cosine_);
    omega_sigma_ = sigma * laws.angular_frequency;
  }

  PENDCORE_INLINE bool are_any() const { return laws_.couples != nullptr || laws_.waves != 0; }
  /// Order k from the angles and rates of order k. The orders are called one after the other, from
  /// 0.
  PENDCORE_INLINE_UNLESS_SMALL Links next(int k, const Links& angle, const Links& rate) {
    Links couple{};
    if (laws_.couples != nullptr) {
      const auto& couples = *laws_.couples;
      // The fourth place of a pack for three links has a rate but no law: its terms are 0.
      const Links scaled_rate = rate - before(rate);  // w sigma
      couple = fma(damping_, scaled_rate, Links(couples.on_phi * (angle - before(angle))));
      if (k == 0) couple = couple + in_time_;
      if (k == 1) couple = couple + sigma_ * couples.slope;
      if (couples.has_powers) couple = couple + of_powers(k, per_sigma_ * scaled_rate);
    }
    if (laws_.waves != 0) {
      couple = fma(number_of(sine_, 0), laws_.gain[0], couple);
      if (laws_.waves > 1) couple = fma(number_of(sine_, 1), laws_.gain[1], couple);
      advance_waves(k);
    }
    return by_ * (couple - after(couple));
  }

 private:
  /// Computes order k + 1 of the waves. Two waves of a single run share a register; in lanes, a
  /// second one is left out if there is none.
  PENDCORE_INLINE void advance_waves(int k) {
    const double share = inverse_of[k + 1];
    if constexpr (Lanes<Number>::width > 1) {
      advance(share, omega_sigma_.first, sine_.first, cosine_.first);
      if (laws_.waves > 1) advance(share, omega_sigma_.second, sine_.second, cosine_.second);
    } else {
      advance(share, omega_sigma_, sine_, cosine_);
    }
  }
  template <class Wave>
  PENDCORE_INLINE static void advance(double share, const Wave& omega_sigma, Wave& sine,
                                      Wave& cosine) {
    const Wave factor = share * omega_sigma;
    const Wave sine_before = sine;
    sine = factor * cosine;
    cosine = -(factor * sine_before);
  }
  PENDCORE_INLINE Links of_powers(int k, const Links& w) {
    const auto rate = [this](int j) __attribute__((always_inline)) { return rates_[j]; };
    const auto square = [this](int j) __attribute__((always_inline)) { return squares_[j]; };
    rates_[k] = w;
    squares_[k] = order_of_product(k, rate, rate);
    const Links cube = order_of_product(k, square, rate);
    return fma(laws_.couples->on_phid2, squares_[k], laws_.couples->on_phid3 * cube);
  }

  const Laws& laws_;
  Time sigma_, per_sigma_;
  OfLinks by_;         ///< sigma^2 times the factor
  OfLinks in_time_{};  ///< held + slope (t - start)
  OfLinks damping_{};  ///< on_phid/sigma
  Waves sine_{}, cosine_{}, omega_sigma_{};
  Links rates_[highest_order];
  Links squares_[highest_order];
};

/// The torques of a run. The effects must neither hold a joint nor move the pivot, and have at most
/// two waves.
template <class Links>
struct CoupleTorque {
  static constexpr bool is_there = true;

  std::shared_ptr<const EffectsInRows<Links>> effects;
  Links factor;
};

}  // namespace pendcore
