/// \file
/// One link: qdd = (a_1 g / A_11) cos q.
///
/// This is the textbook's Eq. (2.1) without a second link, y downward. Cost: one cosine and one
/// product.
#pragma once

#include "arithmetic/pair.hpp"
#include "dynamics/inertia.hpp"

namespace pendcore {

struct SinglePendulum {
  using Links = double;  ///< a quantity of the one link

  double weight;  ///< a_1 g / A_11, 1/s^2

  SinglePendulum(const Inertia& inertia, double gravity)
      : weight(inertia.links[0].first_moment * gravity / inertia.links[0].diagonal) {}

  template <class Real>
  PENDCORE_INLINE Real accelerations(const Real& q, const Real& /*qd*/) const {
    Real s, c;
    sine_cosine(q, s, c);
    return Constants<Real>::of(weight) * c;
  }
};

}  // namespace pendcore
