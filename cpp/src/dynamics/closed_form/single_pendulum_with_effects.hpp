/// \file
/// One link with effects: qdd = (a_1 (g cos q + xdd_0 sin q - ydd_0 cos q) + Q) / A_11, or 0 if its
/// joint is held.
///
/// Cost: the bare equation, 4 more operations, and the effects.
#pragma once

#include "dynamics/acting_effects.hpp"
#include "dynamics/inertia.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

struct SinglePendulumWithEffects {
  using Links = double;

  double length;
  double inverse_inertia;  ///< 1/A_11
  double moment;           ///< a_1/A_11, 1/m
  double weight;           ///< a_1 g/A_11
  const ActingEffects<double>* effects;

  SinglePendulumWithEffects(const Scene& scene, const Inertia& inertia,
                            const ActingEffects<double>* in_force)
      : length(inertia.links[0].length),
        inverse_inertia(1.0 / inertia.links[0].divisor()),
        moment(inertia.links[0].first_moment / inertia.links[0].divisor()),
        weight(inertia.links[0].first_moment * scene.gravity / inertia.links[0].divisor()),
        effects(in_force) {}

  template <class V>
  PENDCORE_INLINE V accelerations(double t, const V& q, const V& qd) const {
    V s, c;
    sines(t, q, s, c);
    V pull = weight * c;
    RowAt<V> at{
        .q = q, .qd = qd, .s = s, .c = c, .L = length, .t = t, .pivot_vx = 0.0, .pivot_vy = 0.0};
    if (!effects->pivots.empty()) {
      double x, y;
      effects->pivot_acceleration(t, x, y);
      pull = fma(V(moment), x * s - y * c, pull);
      if (effects->has_forces) effects->pivot_velocity(t, at.pivot_vx, at.pivot_vy);
    }
    RowLoads<V> loads;
    for (const auto& one : effects->couples) loads.couple(one.torque(at));
    for (const JointWave& one : effects->joint_waves) {
      loads.couple(one.gain * effects->wave_sine[one.wave]);
    }
    for (const auto& entry : effects->entries) ActingEffects<double>::add(entry, at, loads);
    V torque = loads.torque_of_couples() + loads.moments;
    if (!effects->users.empty()) torque += of_users(*effects, t, q, qd);
    return effects->any_held ? V(0.0) : fma(V(inverse_inertia), torque, pull);
  }

 private:
  /// Computes the sine of the link in one pack with the first three waves.
  PENDCORE_INLINE void sines(double t, double q, double& s, double& c) const {
    if (effects->waves == 0) {
      sine_cosine(q, s, c);
      return;
    }
    const double* frequency = effects->angular_frequency.data();
    const double* phase = effects->phase.data();
    Pack<4> angle = fma(load<Pack<4>>(frequency), broadcast<Pack<4>>(t), load<Pack<4>>(phase));
    angle = Pack<4>{angle[0], angle[1], angle[2], q};
    Pack<4> sine, cosine;
    sine_cosine(angle, sine, cosine);
    s = sine[3];
    c = cosine[3];
    store(&effects->wave_sine[0], sine);
    store(&effects->wave_cosine[0], cosine);
    effects->compute_waves(t, 3);
  }
  template <class V>
  PENDCORE_INLINE void sines(double t, const V& q, V& s, V& c) const {
    effects->compute_waves(t, 0);
    sine_cosine(q, s, c);
  }
};

}  // namespace pendcore
