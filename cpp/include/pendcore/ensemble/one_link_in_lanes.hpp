/// \file
/// The equations of one link in lanes (lane_equations.hpp): bare, or with couples and up to four
/// waves of motors and the pivot, or with drag and a pivot that stands still.
#pragma once

#include "pendcore/ensemble/lane_equations.hpp"

namespace pendcore {

/// Puts states of one link into a lane, and takes them out.
template <class Real>
struct OneLink {
  using Integers = typename Lanes<Real>::Integers;
  using Row = EachLink<Real, 1>;
  static constexpr int links = 1;

  static void put_state(Row& row, int lane, const double* from) { row.of[0][lane] = from[0]; }
  static void get_state(const Row& row, int lane, double* to) { to[0] = row.of[0][lane]; }
  PENDCORE_INLINE static const Real& number(const Row& row, int link) { return row.of[link]; }
  PENDCORE_INLINE static Row select(const Integers& which, const Row& yes, const Row& no) {
    return {{which ? yes.of[0] : no.of[0]}};
  }
};

/// One link in every lane, bare or with couples and waves. Which waves there are, and what each of
/// them moves, is the same in all lanes.
template <class Real>
struct SinglePendulumInLanes {
  using Links = EachLink<Real, 1>;
  static constexpr int most_waves = 4;
  /// A wave by its number, and what it gives: N m of a motor, m/s^2 of the pivot along x or y.
  struct Driven {
    int wave = 0;
    Real gain = {};
  };
  struct Pivot {
    Driven x, y;
  };

  Real weight = {}, inverse_inertia = {}, moment = {};
  Real angular_frequency[most_waves] = {}, phase[most_waves] = {};
  Couples<Links> couples;
  Links length{};
  DragInLanes<Links> drag;
  Driven motor[most_waves];
  Pivot pivot[most_waves];
  int waves = 0, motor_count = 0, pivot_count = 0;
  bool is_bare = true;
  bool has_couples = false;

  /// As SinglePendulum and SinglePendulumWithEffects compute it, in the same order.
  PENDCORE_INLINE Links accelerations(const Real& t, const Links& q, const Links& qd) const {
    Links s, c;
    sine_cosine(q, s, c);
    Links pull = weight * c;
    if (is_bare) return pull;
    Real wave[most_waves];
    for (int k = 0; k < waves; ++k) {
      Real cosine;
      sine_cosine(fma(angular_frequency[k], t, phase[k]), wave[k], cosine);
    }
    if (pivot_count > 0) {
      Real x{}, y{};
      for (int k = 0; k < pivot_count; ++k) {
        // A run adds the zero of a spline here, which settles the sign of a zero.
        x = x + fma(pivot[k].x.gain, wave[pivot[k].x.wave], Real{});
        y = y + fma(pivot[k].y.gain, wave[pivot[k].y.wave], Real{});
      }
      pull = fma(moment, x * s - y * c, pull);
    }
    const RowAt<Links, Real> at{t, q, qd, s, c, length, 0.0, 0.0};
    RowLoads<Links> loads;
    if (has_couples) loads.couple(couples.torque(at));
    for (int k = 0; k < motor_count; ++k) loads.couple({{motor[k].gain * wave[motor[k].wave]}});
    if (drag.is_there) drag.law.add(at, loads);
    return fma(inverse_inertia, loads.torque_of_couples() + loads.moments, pull);
  }
};

template <class Real>
struct LaneEquations<SinglePendulum, Real> : OneLink<Real> {
  using Type = SinglePendulumInLanes<Real>;
  using Driven = typename Type::Driven;

  /// Whether the equations of one link have lanes.
  static bool has(const EquationsOfMotion& equations) {
    if (std::holds_alternative<SinglePendulum>(equations.form)) return true;
    const auto* const form = std::get_if<SinglePendulumWithEffects>(&equations.form);
    if (form == nullptr || !equations.are_steady()) return false;
    const ActingEffects<double>& effects = *form->effects;
    return DragInLanes<EachLink<Real, 1>>::has(effects) && effects.users.empty() &&
           effects.waves <= Type::most_waves && effects.joint_waves.size() <= Type::most_waves &&
           effects.pivots.size() <= Type::most_waves;
  }
  static void prepare(Type& equations, const EquationsOfMotion& one) {
    const auto* const form = std::get_if<SinglePendulumWithEffects>(&one.form);
    equations.is_bare = form == nullptr;
    if (form == nullptr) return;
    const ActingEffects<double>& effects = *form->effects;
    equations.has_couples = !effects.couples.empty();
    equations.drag.is_there = !effects.entries.empty();
    equations.waves = effects.waves;
    equations.motor_count = static_cast<int>(effects.joint_waves.size());
    equations.pivot_count = static_cast<int>(effects.pivots.size());
    for (int k = 0; k < equations.motor_count; ++k) {
      equations.motor[k].wave = effects.joint_waves[k].wave;
    }
    for (int k = 0; k < equations.pivot_count; ++k) {
      equations.pivot[k].x.wave = effects.pivots[k]->x.wave;
      equations.pivot[k].y.wave = effects.pivots[k]->y.wave;
    }
  }
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    if (const auto* const bare = std::get_if<SinglePendulum>(&from.form)) {
      equations.weight[lane] = bare->weight;
      return equations.is_bare;
    }
    if (equations.is_bare || !has(from)) return false;
    const auto& form = std::get<SinglePendulumWithEffects>(from.form);
    const ActingEffects<double>& effects = *form.effects;
    // A motor of amplitude 0 has no joint wave: its member has other equations.
    const bool is_alike = equations.has_couples == !effects.couples.empty() &&
                          equations.drag.is_there == !effects.entries.empty() &&
                          equations.waves == effects.waves &&
                          equations.motor_count == static_cast<int>(effects.joint_waves.size()) &&
                          equations.pivot_count == static_cast<int>(effects.pivots.size());
    if (!is_alike) return false;
    equations.weight[lane] = form.weight;
    equations.inverse_inertia[lane] = form.inverse_inertia;
    equations.moment[lane] = form.moment;
    put_row(equations.length, lane, form.length);
    const auto* const drag = DragInLanes<EachLink<Real, 1>>::law_of(effects);
    if (drag != nullptr) equations.drag.put(lane, *drag);
    if (equations.has_couples) put_couples(equations.couples, lane, effects.couples.front());
    for (int k = 0; k < equations.waves; ++k) {
      equations.angular_frequency[k][lane] = effects.angular_frequency[k];
      equations.phase[k][lane] = effects.phase[k];
    }
    const auto put_wave = [lane](Driven& to, int wave, double gain) {
      to.gain[lane] = gain;
      return to.wave == wave;
    };
    bool is_same = true;
    for (int k = 0; k < equations.motor_count; ++k) {
      const JointWave& one = effects.joint_waves[k];
      is_same &= put_wave(equations.motor[k], one.wave, one.gain);
    }
    for (int k = 0; k < equations.pivot_count; ++k) {
      const DrivenPivot::Law& law = *effects.pivots[k];
      is_same &= put_wave(equations.pivot[k].x, law.x.wave, law.x.gain);
      is_same &= put_wave(equations.pivot[k].y, law.y.wave, law.y.gain);
    }
    return is_same;
  }
};

}  // namespace pendcore
