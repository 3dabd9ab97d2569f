/// \file
/// An effect that the core does not have: the uplift of a rod in a fluid, at its middle,
///
///     F = -B e_y
///
/// with B the weight of the displaced fluid; y points down.
#pragma once

#include "pendcore/effects/hooks.hpp"

namespace pendcore {

struct Buoyancy {
  int link = 0;
  double uplift = 0.0;

  static constexpr EffectInfo info{.name = "Buoyancy",
                                   .kind = "buoyancy",
                                   .sentence = "The uplift of a link in a fluid.",
                                   .law = "F = -B e_y",
                                   .source = "Archimedes, On Floating Bodies",
                                   .account = Account::user};
  static constexpr Hooks hooks{.law = true};
  static constexpr auto parameters = std::tuple{
      parameter(&Buoyancy::link, link_number),
      parameter(&Buoyancy::uplift, {.name = "uplift",
                                    .symbol = "B",
                                    .unit = "N",
                                    .sentence = "weight of the displaced fluid",
                                    .required = true}),
  };

  template <class Row>
  struct Law {
    Row uplift{};

    template <class At, class Loads>
    PENDCORE_INLINE void add(const At& at, Loads& loads) const {
      using V = typename At::Value;
      const V fy = -Constants<V>::of(uplift);
      loads.force(Constants<V>::of(0.5) * at.length() * (fy * at.c), Constants<V>::of(0.0), fy);
    }
  };

  template <class Row>
  void put(Law<Row>& law, int lane, const LinkConstants& /*on*/) const {
    set_lane(law.uplift, lane, uplift);
  }
};

}  // namespace pendcore
