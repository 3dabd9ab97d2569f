/// \file
/// One link with effects: qdd = (a_1 (g cos q + xdd_0 sin q - ydd_0 cos q) + Q) / A_11, or 0 if its
/// joint is held.
///
/// Cost: the bare equation, 4 more operations, and the effects.
#pragma once

#include "arithmetic/row_of_links.hpp"
#include "dynamics/effects_in_rows.hpp"
#include "dynamics/inertia.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

/// `AnyEffects` are EffectsInRows<double>, or EffectsInLanes with a trajectory in each lane. There,
/// a form for couples alone saves a seventh of the time of a short step.
template <class AnyEffects, bool couples_alone = false>
struct LoadedSinglePendulum {
  using Effects = AnyEffects;
  using Links = typename Effects::Row;
  using Number = typename Effects::Number;

  Links length{};
  Links inverse_inertia{};  ///< 1/A_11
  Links moment{};           ///< a_1/A_11, 1/m
  Links weight{};           ///< a_1 g/A_11
  const Effects* effects = nullptr;

  LoadedSinglePendulum() = default;
  /// The equations of a run.
  LoadedSinglePendulum(const Scene& scene, const Inertia& inertia, const Effects* in_force)
      : length(inertia.links[0].length),
        inverse_inertia(1.0 / inertia.links[0].divisor()),
        moment(inertia.links[0].first_moment / inertia.links[0].divisor()),
        weight(inertia.links[0].first_moment * scene.gravity / inertia.links[0].divisor()),
        effects(in_force) {}

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.length, x.inverse_inertia, x.moment, x.weight);
  }

  template <class V>
  PENDCORE_INLINE V accelerations(const Number& t, const V& q, const V& qd) const {
    using Constant = Constants<V>;
    V s, c;
    if constexpr (couples_alone) {
      sine_cosine(q, s, c);
    } else {
      sines(t, q, s, c);
    }
    V pull = Constant::of(weight) * c;
    if (!effects->are_any()) return pull;
    RowAt<V, Number> at{.q = q, .qd = qd, .s = s, .c = c, .L = Constant::of(length), .t = t};
    RowLoads<V> loads;
    if (!effects->couples.empty()) loads.couple(effects->couples.front().torque(at));
    if constexpr (!couples_alone) {
      if (!effects->are_couples_alone) add_more(at, loads, pull);
    }
    const V torque = loads.torque_of_couples() + loads.moments;
    return effects->any_held ? Constant::of(0.0) : fma(Constant::of(inverse_inertia), torque, pull);
  }

 private:
  /// Adds what is not a couple without a wave.
  template <class V>
  PENDCORE_INLINE void add_more(RowAt<V, Number>& at, RowLoads<V>& loads, V& pull) const {
    using Constant = Constants<V>;
    add_pivot(*effects, Constant::of(moment), at, pull);
    for (const auto& one : effects->joint_waves) {
      loads.couple(Constant::of(Number(one.gain * effects->wave_sine[one.wave])));
    }
    for (const auto& entry : effects->entries) Effects::add(entry, at, loads);
    if constexpr (requires { effects->users; }) {
      if (!effects->users.empty()) loads.generalised(of_users(*effects, at.t, at.q, at.qd));
    }
  }

  /// Computes the sine of the link in one pack with the first three waves.
  PENDCORE_INLINE void sines(double t, double q, double& s, double& c) const {
    if (effects->waves == 0) {
      sine_cosine(q, s, c);
      return;
    }
    Pack<4> angle =
        fma(effects->angular_frequency.row(0), broadcast<Pack<4>>(t), effects->phase.row(0));
    angle = Pack<4>{angle[0], angle[1], angle[2], q};
    Pack<4> sine, cosine;
    sine_cosine(angle, sine, cosine);
    s = sine[3];
    c = cosine[3];
    effects->wave_sine.set_row(0, sine);
    effects->wave_cosine.set_row(0, cosine);
    effects->compute_waves(t, 3);
  }
  template <class V>
  PENDCORE_INLINE void sines(const Number& t, const V& q, V& s, V& c) const {
    effects->compute_waves(t, 0);
    sine_cosine(q, s, c);
  }
};

using SinglePendulumWithEffects = LoadedSinglePendulum<EffectsInRows<double>>;

}  // namespace pendcore
