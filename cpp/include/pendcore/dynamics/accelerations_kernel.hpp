/// \file
/// The accelerations of any form of the equations of motion, as kernels that have clones.
#pragma once

#include <type_traits>

#include "pendcore/arithmetic/dual.hpp"

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

}  // namespace pendcore
