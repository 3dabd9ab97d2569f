/// \file
/// The right-hand side of the textbook's double pendulum.
///
/// The Newton-Euler equations (2.1)-(2.4) of both links, y downward (docs/reference/errata.md says
/// why), with the reaction F_21 eliminated as in (2.9)-(2.11), for general links:
///
///     A_11 qdd_1 + A_12 cos(q_1 - q_2) qdd_2 + A_12 sin(q_1 - q_2) qd_2^2 = a_1 g cos q_1
///     A_22 qdd_2 + A_12 cos(q_2 - q_1) qdd_1 + A_12 sin(q_2 - q_1) qd_1^2 = a_2 g cos q_2
///
/// with the inertias A_11, A_22, A_12 (kg m^2) and the first moments a_1, a_2 (kg m) of
/// dynamics/inertia.hpp.
///
/// Each equation is divided by its own A_ii, so that no ratio of masses or lengths overflows. Both
/// are then written as one, where x is a quantity of a link and x' the same quantity of the other
/// link:
///
///     gamma = a g / A,  rho = A_12 / A,      C = cos(q - q'),  S = sin(q - q')
///     f = gamma cos q - rho S qd'^2          what each link would do alone
///     qdd = (f - rho C f') / D,              D = 1 - rho rho' C^2 = delta + rho rho' S^2
///
/// delta = 1 - rho rho' is a sum of positive terms (see the constructor), so that D keeps its
/// digits even where link 1 weighs almost nothing. For uniform rods D > 1/4.
///
/// Cost: one sine and cosine of a pair, one division, 16 more operations. Throws nothing.
#pragma once

#include "arithmetic/pair.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/inertia.hpp"

namespace pendcore {

/// The equations with constants of the links in `AnyLinks`, and other constants in `Number`: a Pair
/// and doubles for one trajectory, packs for a trajectory in each lane.
template <class AnyLinks, class Number>
struct DoublePendulumEquations {
  using Links = AnyLinks;  ///< a quantity of both links

  AnyLinks weight;    ///< gamma, 1/s^2
  AnyLinks coupling;  ///< rho
  Number product;     ///< rho rho'
  Number delta;       ///< 1 - rho rho'

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.weight, x.coupling, x.product, x.delta);
  }

  /// qdd (rad/s^2) from q (rad) and qd (rad/s), for each type of pair in pair.hpp.
  template <class AnyPair>
  PENDCORE_INLINE AnyPair accelerations(const AnyPair& q, const AnyPair& qd) const {
    using Constant = Constants<AnyPair>;
    const AnyPair rho = Constant::of(coupling);
    AnyPair s, c;
    sine_cosine(q, s, c);
    const AnyPair c_other = other(c);
    const AnyPair cosine = fma(c, c_other, s * other(s));  // C
    const AnyPair sine =
        fma(s, c_other, -(c * other(s)));  // S; for the other link it has the opposite sign
    const AnyPair determinant = fma(Constant::of(product) * sine, sine, Constant::of(delta));
    const AnyPair qd_other = other(qd);
    const AnyPair alone = fma(-(rho * sine), qd_other * qd_other, Constant::of(weight) * c);
    return fma(-(rho * cosine), other(alone), alone) * (1.0 / determinant);
  }
};

struct DoublePendulum : DoublePendulumEquations<Pair, double> {
  DoublePendulum(const Scene& scene, const Inertia& inertia);
};

}  // namespace pendcore
