/// \file
/// The forms of the equations that Runge-Kutta methods take in lanes: the same equations as those
/// of a single run, with a trajectory, and its constants, in each lane.
///
/// With effects, these are couples that never change their mode, and waves of motors and the pivot:
/// at most two, or four for one link.
#pragma once

#include "pendcore/arithmetic/row_of_links.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"

namespace pendcore {

/// Whether no effect of the equations changes its law or holds a joint along a run.
inline bool are_steady(const EquationsOfMotion& equations) {
  return !equations.effects || (!equations.effects->has_modes && !equations.effects->any_held);
}

/// Puts the numbers of one trajectory into a lane.
template <class Real>
void put_row(Two<Real>& row, int lane, const Pair& one) {
  row.first[lane] = one[0];
  row.second[lane] = one[1];
}
template <class Real, int links>
void put_row(EachLink<Real, links>& row, int lane, const Pack<4>& one) {
  for (int i = 0; i < links; ++i) row.of[i][lane] = one[i];
}
/// Puts what the equations of a double pendulum and their series have in common.
template <class Equations, class One>
void put_constants(Equations& equations, int lane, const One& one) {
  put_row(equations.weight, lane, one.weight);
  put_row(equations.coupling, lane, one.coupling);
  put_row(equations.rotor, lane, one.rotor);
  equations.product[lane] = one.product;
  equations.delta[lane] = one.delta;
  equations.epsilon[lane] = one.epsilon;
}
template <class Real>
void put_row(EachLink<Real, 1>& row, int lane, double one) {
  row.of[0][lane] = one;
}
template <class Rows, class Row>
void put_couples(Couples<Rows>& couples, int lane, const Couples<Row>& one) {
  put_row(couples.held, lane, one.held);
  put_row(couples.slope, lane, one.slope);
  put_row(couples.start, lane, one.start);
  put_row(couples.on_phi, lane, one.on_phi);
  put_row(couples.on_phid, lane, one.on_phid);
  put_row(couples.on_phid2, lane, one.on_phid2);
  put_row(couples.on_phid3, lane, one.on_phid3);
}

/// Puts states of one link into a lane, and takes them out.
template <class Real>
struct OneLink {
  using Integers = typename Lanes<Real>::Integers;
  using Row = EachLink<Real, 1>;

  static void put_state(Row& row, int lane, const double* from) { row.of[0][lane] = from[0]; }
  static void get_state(const Row& row, int lane, double* to) { to[0] = row.of[0][lane]; }
  PENDCORE_INLINE static Row select(const Integers& which, const Row& yes, const Row& no) {
    return {{which ? yes.of[0] : no.of[0]}};
  }
};

/// Puts states of both links into a lane, and takes them out.
template <class Real>
struct BothLinks {
  using Integers = typename Lanes<Real>::Integers;

  static void put_state(Two<Real>& pair, int lane, const double* from) {
    pair.first[lane] = from[0];
    pair.second[lane] = from[1];
  }
  static void get_state(const Two<Real>& pair, int lane, double* to) {
    to[0] = pair.first[lane];
    to[1] = pair.second[lane];
  }
  PENDCORE_INLINE static Two<Real> select(const Integers& which, const Two<Real>& yes,
                                          const Two<Real>& no) {
    return {which ? yes.first : no.first, which ? yes.second : no.second};
  }
};

/// Type is the equations in lanes, which prepare() prepares for members like the given one. put()
/// puts the constants of one trajectory into a lane; it returns false if its equations have another
/// form.
template <class Form, class Real>
struct LaneEquations;

template <class Real>
struct LaneEquations<DoublePendulum, Real> : BothLinks<Real> {
  using Type = DoublePendulumEquations<Two<Real>, Real>;
  static void prepare(Type& /*equations*/, const EquationsOfMotion& /*one*/) {}
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    const auto* const one = std::get_if<DoublePendulum>(&from.form);
    if (one == nullptr) return false;
    put_row(equations.weight, lane, one->weight);
    put_row(equations.coupling, lane, one->coupling);
    equations.product[lane] = one->product;
    equations.delta[lane] = one->delta;
    return true;
  }
};

/// A double pendulum with couples, and perhaps with waves, in every lane.
template <class Real>
struct LoadedDoublePendulumInLanes : LoadedDoublePendulum<Two<Real>, Real> {
  Couples<Two<Real>> couples;
  WavesOf<Two<Real>> waves;
  bool has_waves = false;

  PENDCORE_INLINE Two<Real> accelerations(const Real& t, const Two<Real>& q,
                                          const Two<Real>& qd) const {
    using V = Two<Real>;
    V s, c;
    sine_cosine(q, s, c);
    const typename LoadedDoublePendulum<V, Real>::template Between<V> between(s, c);
    const RowAt<V, Real> at{t, q, qd, s, c, {}, 0.0, 0.0};
    const RowLoads<V> loads{.couples = couples.torque(at)};
    V torque = loads.torque_of_couples();
    if (has_waves) {
      V wave, cosine;
      sine_cosine(fma(waves.angular_frequency, V{t, t}, waves.phase), wave, cosine);
      torque = with_waves(torque, waves, wave, s, c);
    }
    return this->both_free(this->alone(torque, this->weight * c, between, qd), this->kappa(between),
                           between);
  }
};

/// One link in every lane, bare or with couples and waves. Which waves there are, and what each of
/// them moves, is the same in all lanes.
template <class Real>
struct SinglePendulumInLanes {
  using Links = EachLink<Real, 1>;
  static constexpr int most_waves = 4;
  /// A wave, counted from 0, and its amplitude: N m of a motor, m/s^2 of the pivot along x or y.
  struct Moved {
    int wave = 0;
    Real gain = {};
  };
  struct Pivot {
    Moved x, y;
  };

  bool is_bare = true;
  Real weight = {}, inverse_inertia = {}, moment = {};
  bool has_couples = false;
  Couples<Links> couples;
  int waves = 0;
  Real angular_frequency[most_waves] = {}, phase[most_waves] = {};
  int motors = 0;
  Moved motor[most_waves];
  int pivots = 0;
  Pivot pivot[most_waves];

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
    if (pivots > 0) {
      Real x{}, y{};
      for (int k = 0; k < pivots; ++k) {
        x = x + fma(pivot[k].x.gain, wave[pivot[k].x.wave], Real{});
        y = y + fma(pivot[k].y.gain, wave[pivot[k].y.wave], Real{});
      }
      pull = fma(moment, x * s - y * c, pull);
    }
    RowLoads<Links> loads;
    if (has_couples) loads.couple(couples.torque(RowAt<Links, Real>{t, q, qd, s, c, {}, 0.0, 0.0}));
    for (int k = 0; k < motors; ++k) loads.couple({{motor[k].gain * wave[motor[k].wave]}});
    return fma(inverse_inertia, loads.torque_of_couples() + loads.moments, pull);
  }
};

template <class Real>
struct LaneEquations<SinglePendulum, Real> : OneLink<Real> {
  using Type = SinglePendulumInLanes<Real>;
  using Moved = typename Type::Moved;

  /// Whether the equations of one link have lanes.
  static bool has(const EquationsOfMotion& equations) {
    if (std::holds_alternative<SinglePendulum>(equations.form)) return true;
    if (!std::holds_alternative<SinglePendulumWithEffects>(equations.form)) return false;
    const auto& effects = dynamic_cast<const ActingEffects<double>&>(*equations.effects);
    return are_steady(equations) && effects.entries.empty() && effects.users.empty() &&
           effects.waves <= Type::most_waves && effects.pivots.size() <= Type::most_waves;
  }
  static void prepare(Type& equations, const EquationsOfMotion& one) {
    const auto* const form = std::get_if<SinglePendulumWithEffects>(&one.form);
    equations.is_bare = form == nullptr;
    if (form == nullptr) return;
    const ActingEffects<double>& effects = *form->effects;
    equations.has_couples = !effects.couples.empty();
    equations.waves = effects.waves;
    equations.motors = static_cast<int>(effects.joint_waves.size());
    equations.pivots = static_cast<int>(effects.pivots.size());
    for (int k = 0; k < equations.motors; ++k) {
      equations.motor[k].wave = effects.joint_waves[k].wave;
    }
    for (int k = 0; k < equations.pivots; ++k) {
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
    // An amplitude of 0 is no wave, so that one member may have fewer.
    const bool is_alike = equations.has_couples == !effects.couples.empty() &&
                          equations.waves == effects.waves &&
                          equations.motors == static_cast<int>(effects.joint_waves.size()) &&
                          equations.pivots == static_cast<int>(effects.pivots.size());
    if (!is_alike) return false;
    equations.weight[lane] = form.weight;
    equations.inverse_inertia[lane] = form.inverse_inertia;
    equations.moment[lane] = form.moment;
    if (equations.has_couples) put_couples(equations.couples, lane, effects.couples.front());
    for (int k = 0; k < equations.waves; ++k) {
      equations.angular_frequency[k][lane] = effects.angular_frequency[k];
      equations.phase[k][lane] = effects.phase[k];
    }
    const auto put_wave = [lane](Moved& to, int wave, double gain) {
      to.gain[lane] = gain;
      return to.wave == wave;
    };
    bool is_same = true;
    for (int k = 0; k < equations.motors; ++k) {
      const JointWave& one = effects.joint_waves[k];
      is_same &= put_wave(equations.motor[k], one.wave, one.gain);
    }
    for (int k = 0; k < equations.pivots; ++k) {
      const DrivenPivot::Law& law = *effects.pivots[k];
      is_same &= put_wave(equations.pivot[k].x, law.x.wave, law.x.gain);
      is_same &= put_wave(equations.pivot[k].y, law.y.wave, law.y.gain);
    }
    return is_same;
  }
};

/// The forms with couples, and with couples and waves, share the equations in lanes.
using CouplesAndWaves = DoublePendulumWithEffects<Parts::waves>;

template <class Real>
struct LaneEquations<CouplesAndWaves, Real> : BothLinks<Real> {
  using Type = LoadedDoublePendulumInLanes<Real>;

  static void prepare(Type& equations, const EquationsOfMotion& one) {
    equations.has_waves = std::holds_alternative<CouplesAndWaves>(one.form);
  }
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    if (!are_steady(from)) return false;
    const auto put_form = [&](const auto* one, bool has_waves) {
      if (one == nullptr || has_waves != equations.has_waves) return false;
      put(equations, lane, *one);
      put_couples(equations.couples, lane, *one->couples);
      put(equations.waves, lane, one->effects->two_waves);
      return true;
    };
    using WithCouples = DoublePendulumWithEffects<Parts::couples>;
    return put_form(std::get_if<WithCouples>(&from.form), false) ||
           put_form(std::get_if<CouplesAndWaves>(&from.form), true);
  }

 private:
  static void put(LoadedDoublePendulum<Two<Real>, Real>& equations, int lane,
                  const LoadedDoublePendulum<Pair, double>& one) {
    put_row(equations.inverse_diagonal, lane, one.inverse_diagonal);
    put_constants(equations, lane, one);
  }
  static void put(WavesOf<Two<Real>>& waves, int lane, const TwoWaves& one) {
    put_row(waves.angular_frequency, lane, one.angular_frequency);
    put_row(waves.phase, lane, one.phase);
    for (int k = 0; k < 2; ++k) {
      put_row(waves.torque[k], lane, one.torque[k]);
      put_row(waves.on_sine[k], lane, one.on_sine[k]);
      put_row(waves.on_cosine[k], lane, one.on_cosine[k]);
    }
  }
};

}  // namespace pendcore
