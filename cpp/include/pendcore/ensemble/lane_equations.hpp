/// \file
/// The forms of the equations that Runge-Kutta methods take in lanes: the same equations as those
/// of a single run, with a trajectory, and its constants, in each lane.
///
/// With effects, these are couples that never change their mode, and waves of motors and the pivot.
/// Here are the forms of two links, with at most two waves; one_link_in_lanes.hpp has those of one.
#pragma once

#include "pendcore/arithmetic/row_of_links.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"

namespace pendcore {

/// Puts the numbers of one trajectory into a lane.
template <class Real>
void put_row(EachLink<Real, 1>& row, int lane, double one) {
  row.of[0][lane] = one;
}
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

/// Puts states of both links into a lane, and takes them out.
template <class Real>
struct BothLinks {
  using Integers = typename Lanes<Real>::Integers;
  static constexpr int links = 2;

  static void put_state(Two<Real>& pair, int lane, const double* from) {
    pair.first[lane] = from[0];
    pair.second[lane] = from[1];
  }
  static void get_state(const Two<Real>& pair, int lane, double* to) {
    to[0] = pair.first[lane];
    to[1] = pair.second[lane];
  }
  PENDCORE_INLINE static const Real& number(const Two<Real>& pair, int link) {
    return link == 0 ? pair.first : pair.second;
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
