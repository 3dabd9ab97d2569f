/// \file
/// The forms of the equations that Runge-Kutta methods take in lanes: the same equations as those
/// of a single run, with a trajectory, and its constants, in each lane.
///
/// With effects, these are couples that never change their mode, waves of motors and the pivot, and
/// drag. Here are the forms of two links, with at most two waves, or with drag and no wave;
/// one_link_in_lanes.hpp has those of one link, few_links_in_lanes.hpp those of three and four.
#pragma once

#include "arithmetic/row_of_links.hpp"
#include "dynamics/equations_of_motion.hpp"

namespace pendcore {

/// Puts a number of one trajectory, or a row of them, into a lane.
template <class Real>
void put_number(Real& x, int lane, double one) {
  x[lane] = one;
}
template <class Real>
void put_number(EachLink<Real, 1>& row, int lane, double one) {
  row.of[0][lane] = one;
}
template <class Real>
void put_number(Two<Real>& row, int lane, const Pair& one) {
  row.first[lane] = one[0];
  row.second[lane] = one[1];
}
template <class Real, int links>
void put_number(EachLink<Real, links>& row, int lane, const Pack<4>& one) {
  for (int i = 0; i < links; ++i) row.of[i][lane] = one[i];
}
/// Puts the constants of one trajectory into a lane.
template <class Constants, class One>
void put_constants(Constants& constants, int lane, const One& one) {
  each_field(constants, one,
             [lane](auto& all, const auto& of_one) { put_number(all, lane, of_one); });
}

/// The drag on rods in lanes: at most one for each link, and only where the pivot stands still.
template <class Row>
struct DragInLanes {
  RodDragLaw<Row> law;
  bool is_there = false;

  /// Whether a trajectory has no laws but this one, and none beside a moving pivot.
  template <class OfRun>
  static bool has(const ActingEffects<OfRun>& effects) {
    if (effects.entries.empty()) return true;
    return effects.entries.size() == 1 && effects.pivots.empty() && law_of(effects) != nullptr;
  }
  /// The law of a trajectory; null if it has none.
  template <class OfRun>
  static const RodDragLaw<OfRun>* law_of(const ActingEffects<OfRun>& effects) {
    if (effects.entries.empty()) return nullptr;
    const auto* const shared =
        std::get_if<const SharedLaw<RodDragLaw, OfRun>*>(&effects.entries.front().law);
    return shared != nullptr ? &(*shared)->law : nullptr;
  }
};

/// Puts states of both links into a lane, and takes them out.
template <class Real>
struct StatesOfTwoLinks {
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

/// Puts states of n links into a lane, and takes them out.
template <class Real, int n>
struct StatesOfLinks {
  using Integers = typename Lanes<Real>::Integers;
  using Row = EachLink<Real, n>;
  static constexpr int links = n;

  static void put_state(Row& row, int lane, const double* from) {
    for (int i = 0; i < n; ++i) row.of[i][lane] = from[i];
  }
  static void get_state(const Row& row, int lane, double* to) {
    for (int i = 0; i < n; ++i) to[i] = row.of[i][lane];
  }
  PENDCORE_INLINE static const Real& number(const Row& row, int link) { return row.of[link]; }
  PENDCORE_INLINE static Row select(const Integers& which, const Row& yes, const Row& no) {
    return row_detail::each<Real, n>(
        [&](int i) __attribute__((always_inline)) { return which ? yes.of[i] : no.of[i]; });
  }
};

/// Type is the equations in lanes, which prepare() prepares for members like the given one. put()
/// puts the constants of one trajectory into a lane; it returns false if its equations have another
/// form.
template <class Form, class Real>
struct LaneEquations;

template <class Real>
struct LaneEquations<DoublePendulum, Real> : StatesOfTwoLinks<Real> {
  using Type = DoublePendulumEquations<Two<Real>, Real>;
  static void prepare(Type& /*equations*/, const EquationsOfMotion& /*one*/) {}
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    const auto* const one = std::get_if<DoublePendulum>(&from.form);
    if (one == nullptr) return false;
    put_constants(equations, lane, *one);
    return true;
  }
};

/// A double pendulum with couples, and perhaps with waves or drag, in every lane.
template <class Real>
struct LoadedDoublePendulumInLanes : LoadedDoublePendulum<Two<Real>, Real> {
  Couples<Two<Real>> couples;
  WavesOf<Two<Real>> waves;
  bool has_waves = false;
  Two<Real> length{};
  DragInLanes<Two<Real>> drag;

  PENDCORE_INLINE Two<Real> accelerations(const Real& t, const Two<Real>& q,
                                          const Two<Real>& qd) const {
    using V = Two<Real>;
    V s, c;
    sine_cosine(q, s, c);
    const typename LoadedDoublePendulum<V, Real>::template Between<V> between(s, c);
    const RowAt<V, Real> at{
        .q = q, .qd = qd, .s = s, .c = c, .L = length, .t = t, .pivot_vx = 0.0, .pivot_vy = 0.0};
    RowLoads<V> loads{.couples = couples.torque(at)};
    if (drag.is_there) drag.law.add(at, loads);
    V torque = loads.torque_of_couples();
    if (drag.is_there) torque = torque + loads.moments + loads.torque_of_forces(at);
    if (has_waves) {
      V wave, cosine;
      sine_cosine(fma(waves.angular_frequency, V{t, t}, waves.phase), wave, cosine);
      torque = with_waves(torque, waves, wave, s, c);
    }
    return this->both_free(this->alone(torque, this->weight * c, between, qd), this->kappa(between),
                           between);
  }
};

using CouplesAlone = DoublePendulumWithEffects<Parts::couples>;
using CouplesAndLaws = DoublePendulumWithEffects<Parts::laws>;
using CouplesAndWaves = DoublePendulumWithEffects<Parts::waves>;

/// Two links with effects: the forms with couples, with couples and waves, and with couples and
/// drag share their equations in lanes.
struct TwoLinksWithEffects;

template <class Real>
struct LaneEquations<TwoLinksWithEffects, Real> : StatesOfTwoLinks<Real> {
  using Type = LoadedDoublePendulumInLanes<Real>;

  static void prepare(Type& equations, const EquationsOfMotion& one) {
    equations.has_waves = std::holds_alternative<CouplesAndWaves>(one.form);
    equations.drag.is_there = std::holds_alternative<CouplesAndLaws>(one.form);
  }
  /// Whether the equations have lanes.
  static bool has(const EquationsOfMotion& from) {
    if (!from.are_steady()) return false;
    if (const auto* const laws = std::get_if<CouplesAndLaws>(&from.form)) {
      return DragInLanes<Two<Real>>::has(*laws->effects);
    }
    return std::holds_alternative<CouplesAlone>(from.form) ||
           std::holds_alternative<CouplesAndWaves>(from.form);
  }
  static bool put(Type& equations, int lane, const EquationsOfMotion& from) {
    if (!has(from)) return false;
    const auto put_form = [&](const auto* one, bool has_waves, bool has_drag) {
      const bool is_alike = has_waves == equations.has_waves && has_drag == equations.drag.is_there;
      if (one == nullptr || !is_alike) return false;
      put_constants(equations, lane, *one);
      put_constants(equations.couples, lane, *one->couples);
      put_constants(equations.waves, lane, one->effects->two_waves);
      put_number(equations.length, lane, one->length);
      const auto* const drag = DragInLanes<Two<Real>>::law_of(*one->effects);
      if (drag != nullptr) put_constants(equations.drag.law, lane, *drag);
      return true;
    };
    return put_form(std::get_if<CouplesAlone>(&from.form), false, false) ||
           put_form(std::get_if<CouplesAndWaves>(&from.form), true, false) ||
           put_form(std::get_if<CouplesAndLaws>(&from.form), false, true);
  }
};

}  // namespace pendcore
