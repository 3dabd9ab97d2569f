/// \file
/// A law that the core does not have: the uplift of a rod in a fluid, at its middle,
///
///     F = -B e_y
///
/// with B the weight of the displaced fluid; y points down.
#pragma once

#include <tuple>

#include "arithmetic/pair.hpp"

namespace pendcore {

template <class Row>
struct BuoyancyLaw {
  Row uplift{};  ///< B

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.uplift);
  }
  template <class Any>
  static auto shared(Any& /*x*/) {
    return std::tie();
  }

  template <class At, class Loads>
  PENDCORE_INLINE void add(const At& at, Loads& loads) const {
    using V = typename At::Value;
    const V fy = -Constants<V>::of(uplift);
    loads.force(Constants<V>::of(0.5) * at.length() * (fy * at.c), Constants<V>::of(0.0), fy);
  }
};

}  // namespace pendcore
