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

#include "pendcore/dynamics/acting_effects.hpp"
#include "pendcore/dynamics/closed_form/double_pendulum.hpp"
#include "pendcore/dynamics/row.hpp"

namespace pendcore {

/// The effects that a form of the equations supports. It has no instructions for any others.
enum class Parts {
  couples,     ///< rotors, and couples that need no list
  waves,       ///< couples, and at most two waves of motors and the pivot
  laws,        ///< couples and the list of laws
  everything,  ///< any number of waves, any motion of the pivot, users' functions
};

template <Parts parts>
struct DoublePendulumWithEffects {
  using Links = Pair;
  static constexpr bool is_long = parts == Parts::everything;

  Pair length;
  Pair diagonal;          ///< A, kg m^2
  Pair inverse_diagonal;  ///< 1/A
  Pair moment;            ///< a/A, 1/m
  Pair weight;            ///< a g/A
  Pair coupling;          ///< rho
  Pair rotor;             ///< sigma
  double product;         ///< rho rho'
  double delta;
  double epsilon;
  const Couples<Pair>* couples;  ///< the couples on both joints
  const ActingEffects<Pair>* effects;

  DoublePendulumWithEffects(const Scene& scene, const Inertia& inertia,
                            const ActingEffects<Pair>* in_force);

  template <class V>
  PENDCORE_INLINE V accelerations(double t, const V& q, const V& qd) const {
    using Constant = Constants<V>;
    constexpr bool everything = parts == Parts::everything;
    V s, c;
    [[maybe_unused]] Pair wave;
    if constexpr (everything || parts == Parts::waves) {
      wave = sines(t, q, s, c);
    } else {
      sine_cosine(q, s, c);
    }
    const V c_other = other(c);
    const V cosine = fma(c, c_other, s * other(s));   // C
    const V sine = fma(s, c_other, -(c * other(s)));  // S
    const V rho = Constant::of(coupling);
    const V qd_other = other(qd);

    V pull = Constant::of(weight) * c;
    RowAt<V> at{t, q, qd, s, c, Constant::of(length), 0.0, 0.0};
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
      const TwoWaves& two = effects->two_waves;
#pragma GCC unroll 2
      for (int k = 0; k < 2; ++k) {
        const V size = fma(Constant::of(two.on_sine[k]), s,
                           fma(Constant::of(two.on_cosine[k]), c, Constant::of(two.torque[k])));
        torque = fma(Constant::of(wave[k]), size, torque);
      }
    }
    if constexpr (parts == Parts::laws || everything) {
      if (effects->has_forces) torque = torque + loads.torque_of_forces(at);
    }

    const V alone =
        fma(Constant::of(inverse_diagonal), torque, fma(-(rho * sine), qd_other * qd_other, pull));
    const V kappa = fma(rho, cosine, -Constant::of(rotor));
    if (effects->any_held) [[unlikely]]
      return with_joints_held(alone, kappa);
    const V determinant = fma(Constant::of(product) * sine, sine,
                              fma(Constant::of(epsilon), cosine, Constant::of(delta)));
    return fma(-kappa, other(alone), alone) * (1.0 / determinant);
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
  PENDCORE_INLINE V with_joints_held(const V& alone, const V& kappa) const {
    using Constant = Constants<V>;
    const V none = Constant::of(0.0);
    if (effects->held[0] && effects->held[1]) return none;
    if (effects->held[0]) return other(after(alone));
    const V a = Constant::of(diagonal);
    const V moments = a * alone;
    const V inertia = fma(a, kappa, a);
    return (moments + other(moments)) * (1.0 / (inertia + other(inertia)));
  }
};

}  // namespace pendcore
