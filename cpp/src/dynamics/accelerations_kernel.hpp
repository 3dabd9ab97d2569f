/// \file
/// The accelerations of any form of the equations of motion, as kernels that have clones.
#pragma once

#include <type_traits>

#include "arithmetic/dual.hpp"

namespace pendcore {

/// qdd (rad/s^2) of closed-form equations; the bare ones do not depend on time.
template <class Dynamics, class Time, class Links>
PENDCORE_INLINE Links accelerations_at(const Dynamics& dynamics, const Time& t, const Links& q,
                                       const Links& qd) {
  if constexpr (requires { dynamics.accelerations(t, q, qd); }) {
    return dynamics.accelerations(t, q, qd);
  } else {
    return dynamics.accelerations(q, qd);
  }
}

/// qdd (n) from t, q (n) and qd (n). With Number = Dual<double> it also has the change of qdd along
/// the slopes of q and qd.
template <class Dynamics, class Number>
PENDCORE_INLINE void accelerations_in_memory(const Dynamics* dynamics, double t, const Number* q,
                                             const Number* qd, Number* qdd) {
  if constexpr (requires { dynamics->accelerations(t, q, qd, qdd); }) {  // a chain
    dynamics->accelerations(t, q, qd, qdd);
  } else {
    using Row = typename Dynamics::Links;
    using Links = std::conditional_t<std::is_same_v<Number, double>, Row, Dual<Row>>;
    store(qdd, accelerations_at(*dynamics, t, load<Links>(q), load<Links>(qd)));
  }
}

/// Whether equations of two links take several states at once, each in a lane with its own time.
template <class Dynamics>
inline constexpr bool takes_states_in_lanes = false;
template <class Dynamics>
  requires std::is_same_v<typename Dynamics::Links, Pair>
inline constexpr bool takes_states_in_lanes<Dynamics> =
    requires(const Dynamics& one, const Pack<4>& t, const Two<Pack<4>>& x) {
      one.accelerations(t, x, x);
    } || requires(const Dynamics& one, const Two<Pack<4>>& x) { one.accelerations(x, x); };

/// The derivatives of three states (q, qd) at three times: states and derivatives lie one after the
/// other. They have the bits of each state alone.
template <class Dynamics>
PENDCORE_INLINE void derivatives_of_three(const Dynamics* dynamics, const double* t,
                                          const double* y, double* dydt) {
  using Four = Pack<4>;
  const auto a = load<Four>(y);
  const auto b = load<Four>(y + 4);
  const auto c = load<Four>(y + 8);
  // Each state has a lane; the last lane has the last state once more.
  const Four first_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four second_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four first_c = __builtin_shufflevector(c, c, 0, 0, 2, 2);
  const Four second_c = __builtin_shufflevector(c, c, 1, 1, 3, 3);
  const Two<Four> q{__builtin_shufflevector(first_ab, first_c, 0, 1, 4, 5),
                    __builtin_shufflevector(second_ab, second_c, 0, 1, 4, 5)};
  const Two<Four> qd{__builtin_shufflevector(first_ab, first_c, 2, 3, 6, 7),
                     __builtin_shufflevector(second_ab, second_c, 2, 3, 6, 7)};
  const Two<Four> qdd = accelerations_at(*dynamics, Four{t[0], t[1], t[2], t[2]}, q, qd);
  const Four of_ab = __builtin_shufflevector(qdd.first, qdd.second, 0, 4, 1, 5);
  const Four of_c = __builtin_shufflevector(qdd.first, qdd.second, 2, 6, 3, 7);
  store(dydt, Four(__builtin_shufflevector(a, of_ab, 2, 3, 4, 5)));
  store(dydt + 4, Four(__builtin_shufflevector(b, of_ab, 2, 3, 6, 7)));
  store(dydt + 8, Four(__builtin_shufflevector(c, of_c, 2, 3, 4, 5)));
}

}  // namespace pendcore
