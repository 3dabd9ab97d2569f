/// \file
/// The forms of the equations that are taken in lanes: the same equations as those of a single run,
/// with a trajectory, and its constants, in each lane.
#pragma once

#include "pendcore/dynamics/closed_form/double_pendulum.hpp"

namespace pendcore {

template <class Form, class Real>
struct LaneEquations;

template <class Real>
struct LaneEquations<DoublePendulum, Real> {
  using Type = DoublePendulumEquations<Two<Real>, Real>;
  using Integers = typename Lanes<Real>::Integers;

  /// Puts the constants of one trajectory into a lane.
  static void put(Type& equations, int lane, const DoublePendulum& one) {
    put(equations.weight, lane, one.weight);
    put(equations.coupling, lane, one.coupling);
    equations.product[lane] = one.product;
    equations.delta[lane] = one.delta;
  }
  static void put(Two<Real>& pair, int lane, const Pair& one) {
    pair.first[lane] = one[0];
    pair.second[lane] = one[1];
  }
  /// Numbers of both links, angles for example.
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

}  // namespace pendcore
