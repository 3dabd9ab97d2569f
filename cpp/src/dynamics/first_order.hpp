/// \file
/// Equations of motion as the first-order system that an integrator takes: y = (q, qd),
/// dy/dt = (qd, qdd).
#pragma once

#include "dynamics/accelerations_kernel.hpp"

namespace pendcore {

template <class Dynamics>
struct FirstOrder {
  using Block = typename Dynamics::Links;  ///< what one instruction works on
  static constexpr int blocks = 2;         ///< q and qd

  /// Whether the equations are bare: they do not depend on time, and have no effects.
  static constexpr bool is_short =
      requires(const Dynamics& bare, const Block& y) { bare.accelerations(y, y); };

  /// Whether a right-hand side is so long that a step has one copy of it.
  static constexpr bool is_long = requires { requires Dynamics::is_long; };

  Dynamics dynamics;

  /// The derivative dydt (rad/s, rad/s^2) of the state y (rad, rad/s) at time t (s).
  /// If each lane of a block is a trajectory of its own, `t` is a pack, too.
  template <class Time>
  PENDCORE_INLINE void operator()(const Time& t, const Block* y, Block* dydt) const {
    if constexpr (requires { dynamics.derivative(t, y, dydt); }) {  // CalledEquations write it
      dynamics.derivative(t, y, dydt);
    } else {
      dydt[0] = y[1];
      dydt[1] = accelerations_at(dynamics, t, y[0], y[1]);
    }
  }
};

}  // namespace pendcore
