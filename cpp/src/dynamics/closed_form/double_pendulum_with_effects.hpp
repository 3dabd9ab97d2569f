/// \file
/// The double pendulum of double_pendulum.hpp with effects:
///
///     alone    = a (g cos q + xdd_0 sin q - ydd_0 cos q)/A - rho S qd'^2 + Q/A
///     qdd      = (alone - kappa alone') / D,   kappa = rho C - sigma,   D = 1 - kappa kappa'
///              = delta + rho rho' S^2 + epsilon C
///
/// A rotor in joint 2 gives sigma = J_2/A. Then delta = 1 - rho rho' - sigma sigma' and epsilon =
/// rho sigma' + rho' sigma; delta is again a sum of positive terms. Q is the sum of the effects'
/// torques. A held joint is eliminated: with joint 2 held both links turn together, with joint 1
/// held the first link does not turn.
///
/// Cost: the bare equations, 10 more operations, and the effects. Throws what a user's function
/// throws.
#pragma once

#include "dynamics/acting_effects.hpp"
#include "dynamics/closed_form/double_pendulum.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

/// The effects that a form of the equations supports. It has no instructions for any others.
enum class Parts {
  couples,     ///< rotors, and couples that need no list
  waves,       ///< couples, and at most two waves of motors and the pivot
  laws,        ///< couples and the list of laws
  everything,  ///< any number of waves, any motion of the pivot, users' functions
};

/// What all forms share: constants, and the equations for a torque on each link. Types are those of
/// DoublePendulumEquations.
template <class AnyLinks, class Number>
struct LoadedDoublePendulum {
  using Links = AnyLinks;

  AnyLinks inverse_diagonal;  ///< 1/A
  AnyLinks weight;            ///< a g/A
  AnyLinks coupling;          ///< rho
  AnyLinks rotor;             ///< sigma
  Number product;             ///< rho rho'
  Number delta;
  Number epsilon;

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.inverse_diagonal, x.weight, x.coupling, x.rotor, x.product, x.delta,
                    x.epsilon);
  }

  /// C and S of a state.
  template <class V>
  struct Between {
    V cosine, sine;
    PENDCORE_INLINE Between(const V& s, const V& c) {
      const V c_other = other(c);
      cosine = fma(c, c_other, s * other(s));
      sine = fma(s, c_other, -(c * other(s)));
    }
  };
  template <class V>
  PENDCORE_INLINE V alone(const V& torque, const V& pull, const Between<V>& between,
                          const V& qd) const {
    using Constant = Constants<V>;
    const V qd_other = other(qd);
    return fma(Constant::of(inverse_diagonal), torque,
               fma(-(Constant::of(coupling) * between.sine), qd_other * qd_other, pull));
  }
  template <class V>
  PENDCORE_INLINE V kappa(const Between<V>& between) const {
    return fma(Constants<V>::of(coupling), between.cosine, -Constants<V>::of(rotor));
  }
  template <class V>
  PENDCORE_INLINE V both_free(const V& alone, const V& kappa, const Between<V>& between) const {
    using Constant = Constants<V>;
    const V determinant = fma(Constant::of(product) * between.sine, between.sine,
                              fma(Constant::of(epsilon), between.cosine, Constant::of(delta)));
    return fma(-kappa, other(alone), alone) * (1.0 / determinant);
  }
};

/// What two waves, whose sines are `wave`, add to a torque (TwoWaves).
template <class V, class Waves, class Sines>
PENDCORE_INLINE V with_waves(V torque, const Waves& two, const Sines& wave, const V& s,
                             const V& c) {
  using Constant = Constants<V>;
#pragma GCC unroll 2
  for (int k = 0; k < 2; ++k) {
    const V size = fma(Constant::of(two.on_sine[k]), s,
                       fma(Constant::of(two.on_cosine[k]), c, Constant::of(two.torque[k])));
    torque = fma(Constant::of(number_of(wave, k)), size, torque);
  }
  return torque;
}

template <Parts parts>
struct DoublePendulumWithEffects : LoadedDoublePendulum<Pair, double> {
  static constexpr bool is_long = parts == Parts::everything;

  Pair length;
  Pair diagonal;                 ///< A, kg m^2
  Pair moment;                   ///< a/A, 1/m
  const Couples<Pair>* couples;  ///< the couples on both joints
  const ActingEffects<Pair>* effects;

  DoublePendulumWithEffects(const Scene& scene, const Inertia& inertia,
                            const ActingEffects<Pair>* in_force);

  /// `t` is a pack if each lane of V has a time of its own, which couples alone take.
  template <class V, class Time>
    requires(std::is_same_v<Time, double> || parts == Parts::couples)
  PENDCORE_INLINE V accelerations(const Time& t, const V& q, const V& qd) const {
    using Constant = Constants<V>;
    constexpr bool everything = parts == Parts::everything;
    V s, c;
    [[maybe_unused]] Pair wave;
    if constexpr (everything || parts == Parts::waves) {
      wave = sines(t, q, s, c);
    } else {
      sine_cosine(q, s, c);
    }
    const Between<V> between(s, c);
    V pull = Constant::of(weight) * c;
    RowAt<V, Time> at{.q = q,
                      .qd = qd,
                      .s = s,
                      .c = c,
                      .L = Constant::of(length),
                      .t = t,
                      .pivot_vx = 0.0,
                      .pivot_vy = 0.0};
    RowLoads<V> loads{.couples = couples->torque(at)};
    if constexpr (everything) {
      for (const JointWave& one : effects->joint_waves) add_wave(one, loads);
      if (!effects->pivots.empty()) {
        double x, y;
        effects->pivot_acceleration(t, x, y);
        pull = fma(Constant::of(moment), Constant::of(x) * s - Constant::of(y) * c, pull);
        if (effects->has_forces) effects->pivot_velocity(t, at.pivot_vx, at.pivot_vy);
      }
      if (!effects->entries.empty()) ActingEffects<Pair>::add_all(effects, &at, &loads);
      if constexpr (Lanes<V>::width == 2) {
        if (!effects->users.empty()) loads.generalised(of_users(*effects, t, q, qd));
      }
    } else if constexpr (parts == Parts::laws) {
      for (const auto& entry : effects->entries) ActingEffects<Pair>::add(entry, at, loads);
    }
    V torque = loads.torque_of_couples();
    if constexpr (parts == Parts::laws || everything) torque = torque + loads.moments;
    if constexpr (parts == Parts::waves) {
      torque = with_waves(torque, effects->two_waves, wave, s, c);
    }
    if constexpr (parts == Parts::laws || everything) {
      if (effects->has_forces) torque = torque + loads.torque_of_forces(at);
    }

    const V f = alone(torque, pull, between, qd);
    const V k = kappa(between);
    if (effects->any_held) [[unlikely]]
      return with_joints_held(f, k);
    return both_free(f, k, between);
  }

 private:
  /// Computes the sines of the links and of the first two waves. For a single trajectory they fit
  /// into one pack.
  PENDCORE_INLINE Pair sines(double t, const Pair& q, Pair& s, Pair& c) const {
    const TwoWaves& two = effects->two_waves;
    const Pair wave = fma(two.angular_frequency, Pair{t, t}, two.phase);
    Pack<4> sine, cosine;
    sine_cosine(joined(q, wave), sine, cosine);
    s = low_half(sine);
    c = low_half(cosine);
    const Pair wave_sine = high_half(sine);
    if constexpr (parts == Parts::everything) {
      store(&effects->wave_sine[0], wave_sine);
      store(&effects->wave_cosine[0], high_half(cosine));
      if (effects->waves > 2) [[unlikely]]
        effects->compute_waves(t, 2);
    }
    return wave_sine;
  }
  template <class V>
  PENDCORE_INLINE Pair sines(double t, const V& q, V& s, V& c) const {
    sine_cosine(q, s, c);
    effects->compute_waves(t, 0);
    return load<Pair>(effects->wave_sine.data());
  }

  template <class V>
  PENDCORE_INLINE void add_wave(const JointWave& one, RowLoads<V>& loads) const {
    Pair torque{};
    torque[one.joint] = one.gain * effects->wave_sine[one.wave];
    loads.couple(Constants<V>::of(torque));
  }

  /// With joint 2 held, qdd is (A_1 f_1 + A_2 f_2)/(A_1 + A_2 + 2 M_12) for both links. With joint
  /// 1 held, it is 0 and f_2.
  template <class V>
  PENDCORE_INLINE V with_joints_held(const V& f, const V& k) const {
    using Constant = Constants<V>;
    const V none = Constant::of(0.0);
    if (effects->held[0] && effects->held[1]) return none;
    if (effects->held[0]) return other(after(f));
    const V a = Constant::of(diagonal);
    const V moments = a * f;
    const V inertia = fma(a, k, a);
    return (moments + other(moments)) * (1.0 / (inertia + other(inertia)));
  }
};

}  // namespace pendcore
