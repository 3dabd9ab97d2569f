/// \file
/// The equations of one link in lanes of Runge-Kutta methods: bare, or with couples, waves
/// (waves_in_lanes.hpp) and drag (DragInLanes in lane_equations.hpp).
#pragma once

#include "ensemble/lane_equations.hpp"
#include "ensemble/waves_in_lanes.hpp"

namespace pendcore {

/// One link in every lane, bare or with couples, waves and drag.
template <class Real>
struct SinglePendulumInLanes {
  using Links = EachLink<Real, 1>;

  Real weight = {}, inverse_inertia = {}, moment = {};
  Couples<Links> couples;
  Links length{};
  DragInLanes<Links> drag;
  WavesInLanes<Real> waves;
  bool is_bare = true;
  bool has_couples = false;

  /// As SinglePendulum and SinglePendulumWithEffects compute it, in the same order.
  PENDCORE_INLINE Links accelerations(const Real& t, const Links& q, const Links& qd) const {
    Links s, c;
    sine_cosine(q, s, c);
    Links pull = weight * c;
    if (is_bare) return pull;
    Real wave[most_waves_in_lanes];
    waves.compute(t, wave);
    if (waves.pivot_count > 0) {
      Real x{}, y{};
      waves.add_acceleration(wave, x, y);
      pull = fma(moment, x * s - y * c, pull);
    }
    const RowAt<Links, Real> at{
        .q = q, .qd = qd, .s = s, .c = c, .L = length, .t = t, .pivot_vx = 0.0, .pivot_vy = 0.0};
    RowLoads<Links> loads;
    if (has_couples) loads.couple(couples.torque(at));
    for (int k = 0; k < waves.motor_count; ++k) {
      loads.couple({{waves.motor[k].gain * wave[waves.motor[k].wave]}});
    }
    if (drag.is_there) drag.law.add(at, loads);
    return fma(inverse_inertia, loads.torque_of_couples() + loads.moments, pull);
  }
};

template <class Real>
struct LaneEquations<SinglePendulum, Real> : StatesOfLinks<Real, 1> {
  using Type = SinglePendulumInLanes<Real>;

  /// Whether the equations of one link have lanes.
  static bool has(const EquationsOfMotion& equations) {
    if (std::holds_alternative<SinglePendulum>(equations.form)) return true;
    const auto* const form = std::get_if<SinglePendulumWithEffects>(&equations.form);
    if (form == nullptr || !equations.are_steady()) return false;
    const ActingEffects<double>& effects = *form->effects;
    return DragInLanes<EachLink<Real, 1>>::has(effects) && effects.users.empty() &&
           WavesInLanes<Real>::has(effects);
  }
  static void prepare(Type& equations, const EquationsOfMotion& one) {
    const auto* const form = std::get_if<SinglePendulumWithEffects>(&one.form);
    equations.is_bare = form == nullptr;
    if (form == nullptr) return;
    const ActingEffects<double>& effects = *form->effects;
    equations.has_couples = !effects.couples.empty();
    equations.drag.is_there = !effects.entries.empty();
    equations.waves.prepare(effects);
  }
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    if (const auto* const bare = std::get_if<SinglePendulum>(&from.form)) {
      equations.weight[lane] = bare->weight;
      return equations.is_bare;
    }
    if (equations.is_bare || !has(from)) return false;
    const auto& form = std::get<SinglePendulumWithEffects>(from.form);
    const ActingEffects<double>& effects = *form.effects;
    const bool is_alike = equations.has_couples == !effects.couples.empty() &&
                          equations.drag.is_there == !effects.entries.empty();
    if (!is_alike) return false;
    equations.weight[lane] = form.weight;
    equations.inverse_inertia[lane] = form.inverse_inertia;
    equations.moment[lane] = form.moment;
    put_number(equations.length, lane, form.length);
    const auto* const drag = DragInLanes<EachLink<Real, 1>>::law_of(effects);
    if (drag != nullptr) put_constants(equations.drag.law, lane, *drag);
    if (equations.has_couples) put_constants(equations.couples, lane, effects.couples.front());
    return equations.waves.put(lane, effects);
  }
};

}  // namespace pendcore
