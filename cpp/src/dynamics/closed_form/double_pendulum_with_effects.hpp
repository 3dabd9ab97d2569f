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

#include "dynamics/closed_form/double_pendulum.hpp"
#include "dynamics/effects_in_rows.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

/// The effects that a form of the equations supports. It has no instructions for any others.
enum class Parts {
  couples,     ///< rotors, and couples that need no list
  waves,       ///< couples, and at most two waves of motors and the pivot
  laws,        ///< couples and the list of laws
  everything,  ///< any number of waves, any motion of the pivot, users' functions
};

/// The equations of all forms. `AnyEffects` are EffectsInRows<Pair>, or EffectsInLanes with a
/// trajectory in each lane.
template <class AnyEffects, Parts parts>
struct LoadedDoublePendulum {
  using Effects = AnyEffects;
  using Links = typename Effects::Row;
  using Number = typename Effects::Number;
  static constexpr bool everything = parts == Parts::everything;
  static constexpr bool is_long = everything;

  Links inverse_diagonal{};  ///< 1/A
  Links weight{};            ///< a g/A
  Links coupling{};          ///< rho
  Links rotor{};             ///< sigma
  Links length{};
  Links diagonal{};  ///< A, kg m^2
  Links moment{};    ///< a/A, 1/m
  Number product{};  ///< rho rho'
  Number delta{};
  Number epsilon{};
  const Couples<Links>* couples = nullptr;  ///< the couples on both joints
  const Effects* effects = nullptr;

  LoadedDoublePendulum() = default;
  /// The equations of a run.
  LoadedDoublePendulum(const Scene& scene, const Inertia& inertia, const Effects* in_force);

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.inverse_diagonal, x.weight, x.coupling, x.rotor, x.length, x.diagonal,
                    x.moment, x.product, x.delta, x.epsilon);
  }

  /// `t` is a pack if each lane of V has a time of its own, which couples alone take in a run.
  template <class V, class Time>
    requires(std::is_same_v<Time, Number> || parts == Parts::couples)
  PENDCORE_INLINE V accelerations(const Time& t, const V& q, const V& qd) const {
    using Constant = Constants<V>;
    V s, c;
    [[maybe_unused]] PairOf<Number> wave;
    if constexpr (parts == Parts::waves || everything) {
      wave = sines(t, q, s, c);
    } else {
      sine_cosine(q, s, c);
    }
    const Between<V> between(s, c);
    V pull = Constant::of(weight) * c;
    RowAt<V, Time> at{.q = q, .qd = qd, .s = s, .c = c, .L = Constant::of(length), .t = t};
    RowLoads<V> loads{.couples = couples->torque(at)};
    if constexpr (everything) add_everything(at, loads, pull);
    if constexpr (parts == Parts::laws) {
      // Most scenes have one law: a loop would part the registers of lanes.
      Effects::add(effects->entries.front(), at, loads);
      for (std::size_t i = 1; i < effects->entries.size(); ++i) [[unlikely]]
        Effects::add(effects->entries[i], at, loads);
    }
    V torque = loads.torque_of_couples();
    if constexpr (parts == Parts::waves) torque = with_two_waves(torque, wave, s, c);
    if constexpr (parts == Parts::laws || everything) {
      torque = torque + loads.moments;
      if (effects->has_forces) torque = torque + loads.torque_of_forces(at);
    }

    const V f = alone(torque, pull, between, qd);
    const V k = kappa(between);
    if (effects->any_held) [[unlikely]]
      return with_joints_held(f, k);
    return both_free(f, k, between);
  }

 private:
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

  /// Adds what no other form has. Users' functions take the state of one trajectory.
  template <class V, class Time>
  PENDCORE_INLINE void add_everything(RowAt<V, Time>& at, RowLoads<V>& loads, V& pull) const {
    using Constant = Constants<V>;
    for (const auto& one : effects->joint_waves) {
      Links torque{};
      set_number(torque, one.joint, Number(one.gain * effects->wave_sine[one.wave]));
      loads.couple(Constant::of(torque));
    }
    add_pivot(*effects, Constant::of(moment), at, pull);
    if (!effects->entries.empty()) Effects::add_all(effects, &at, &loads);
    if constexpr (Lanes<V>::width == 2) {
      if (!effects->users.empty()) loads.generalised(of_users(*effects, at.t, at.q, at.qd));
    }
  }

  /// Adds what the first two waves give, WavesOf.
  template <class V>
  PENDCORE_INLINE V with_two_waves(V torque, const PairOf<Number>& wave, const V& s,
                                   const V& c) const {
    using Constant = Constants<V>;
    const WavesOf<Links>& two = effects->two_waves;
#pragma GCC unroll 2
    for (int k = 0; k < 2; ++k) {
      const V size = fma(Constant::of(two.on_sine[k]), s,
                         fma(Constant::of(two.on_cosine[k]), c, Constant::of(two.torque[k])));
      torque = fma(Constant::of(number_of(wave, k)), size, torque);
    }
    return torque;
  }

  /// Computes the sines of the links and of all waves, and returns those of the first two. For a
  /// single trajectory these and the links fit into one pack.
  PENDCORE_INLINE Pair sines(double t, const Pair& q, Pair& s, Pair& c) const {
    const Pair wave = fma(effects->angular_frequency.pair(0), Pair{t, t}, effects->phase.pair(0));
    Pack<4> sine, cosine;
    sine_cosine(joined(q, wave), sine, cosine);
    s = low_half(sine);
    c = low_half(cosine);
    if constexpr (everything) {
      effects->wave_sine.set_row(0, high_half(sine));
      effects->wave_cosine.set_row(0, high_half(cosine));
      if (effects->waves > 2) [[unlikely]]
        effects->compute_waves(t, 2);
    }
    return high_half(sine);
  }
  template <class V>
  PENDCORE_INLINE PairOf<Number> sines(const Number& t, const V& q, V& s, V& c) const {
    sine_cosine(q, s, c);
    effects->compute_waves(t, 0);
    return effects->wave_sine.pair(0);
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

template <Parts parts>
using DoublePendulumWithEffects = LoadedDoublePendulum<EffectsInRows<Pair>, parts>;

}  // namespace pendcore
