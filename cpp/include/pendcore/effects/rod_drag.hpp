/// \file
/// Air drag along a link, a slender rod across the flow:
///
///     f(s) = -k |w(s)| w(s) n,   k = rho C_d d / 2,   w(s) = w_0 + (w_1 - w_0) s/L
///     w_0 = n . (v - wind),  w_1 = w_0 + L qd         at the near and at the far end
///
/// v is the velocity of the joint where the link begins. The integrals along the rod are its
/// resultant F (along n) and its moment T about that joint. With D = |w_0| + |w_1| they are, for
/// all signs,
///
///     F = -k L   (w_0 + w_1)/D (w_0^2 + |w_0 w_1| + w_1^2) / 3
///     T = -k L^2 ((w_0 |w_0|^3 + w_1 w_1^2 (4 |w_0| + 3 |w_1|))/D^2
///                 + 2 (w_0 w_1 + |w_0 w_1|) (w_0 + w_1)/D) / 12
///
/// Source: the cross-flow principle, Hoerner, Fluid-Dynamic Drag (1965), chapter 3. The loss of the
/// rod is the integral of k |w|^3; the rest of the drag's power is the wind's.
#pragma once

#include "pendcore/effects/hooks.hpp"

namespace pendcore {

struct RodDrag {
  int link = 0;
  double drag_coefficient = 0.0;
  double diameter = 0.0;
  double air_density = 1.225;
  std::array<double, 2> wind = {0.0, 0.0};

  static constexpr EffectInfo info{
      .name = "RodDrag",
      .kind = "rod_drag",
      .sentence = "Air drag on a link, along the whole rod, quadratic in the speed across it.",
      .law =
          "f(s) = -k abs(w) w,  k = rho C_d d / 2,  w(s) is the speed across the rod relative to "
          "the air",
      .source = "Hoerner, Fluid-Dynamic Drag (1965), chapter 3, the cross-flow principle",
      .account = Account::drag,
      .examples = "RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0))",
      .outcome = "drag: 3.696 J"};
  static constexpr Hooks hooks{.law = true, .wind = true};
  static constexpr auto parameters = std::tuple{
      parameter(&RodDrag::link, link_number),
      parameter(&RodDrag::drag_coefficient,
                {.name = "drag_coefficient",
                 .symbol = "C_d",
                 .unit = "1",
                 .sentence = "drag coefficient of the cross-section, about 1.2 for a round rod",
                 .range = Range::not_negative,
                 .required = true}),
      parameter(&RodDrag::diameter, {.name = "diameter",
                                     .symbol = "d",
                                     .unit = "m",
                                     .sentence = "width of the rod across the flow",
                                     .range = Range::not_negative,
                                     .required = true}),
      parameter(&RodDrag::air_density, {.name = "air_density",
                                        .symbol = "rho",
                                        .unit = "kg/m^3",
                                        .sentence = "density of the air or another fluid",
                                        .range = Range::not_negative}),
      parameter(&RodDrag::wind, {.name = "wind",
                                 .symbol = "",
                                 .unit = "m/s",
                                 .sentence = "velocity of the air, x right and y down"}),
  };

  bool has_wind() const { return wind[0] != 0.0 || wind[1] != 0.0; }

  /// w_0 and w_1 of a row of links.
  template <class At, class Row>
  PENDCORE_INLINE static void speeds(const At& at, const Row& wind_x, const Row& wind_y,
                                     typename At::Value& w0, typename At::Value& w1) {
    using V = typename At::Value;
    const V across = at.vx() - Constants<V>::of(wind_x);
    w0 = fma(at.c, at.vy() - Constants<V>::of(wind_y), -(at.s * across));
    w1 = fma(at.length(), at.qd, w0);
  }

  template <class Row>
  struct Law {
    Row minus_k{};      ///< -k L/3
    Row minus_k_arm{};  ///< -k L^2/12
    Row wind_x{};
    Row wind_y{};

    template <class Any>
    static auto fields(Any& x) {
      return std::tie(x.minus_k, x.minus_k_arm, x.wind_x, x.wind_y);
    }

    template <class At, class Loads>
    PENDCORE_INLINE void add(const At& at, Loads& loads) const {
      using V = typename At::Value;
      V w0, w1;
      speeds(at, wind_x, wind_y, w0, w1);
      const V size0 = absolute(w0);
      const V size1 = absolute(w1);
      const V size = size0 + size1 + Constants<V>::of(1e-100);  // D; no 0/0 at rest
      const V inverse = 1.0 / size;
      const V direction = (w0 + w1) * inverse;
      const V size_of_product = size0 * size1;
      // w_0^2 + |w_0 w_1| + w_1^2 = D^2 - |w_0 w_1|
      const V force = (Constants<V>::of(minus_k) * direction) * fma(size, size, -size_of_product);
      const V ends =
          fma(w0 * size0, w0 * w0, (w1 * (w1 * w1)) * fma(Constants<V>::of(3.0), size, size0));
      const V between = fma(w0, w1, size_of_product) * direction;
      const V moment =
          Constants<V>::of(minus_k_arm) * fma(ends * inverse, inverse, between + between);
      loads.force(moment, -(force * at.s), force * at.c);
    }

    /// The integral of k |w|^3 along each rod, W.
    template <class At>
    PENDCORE_INLINE typename At::Value dissipation(const At& at) const {
      using V = typename At::Value;
      V w0, w1;
      speeds(at, wind_x, wind_y, w0, w1);
      const V size0 = absolute(w0);
      const V size1 = absolute(w1);
      const V product = w0 * w1;
      const V fourth = fma(w0 * w0, w0 * w0, (w1 * w1) * (w1 * w1));
      const V size_of_product = absolute(product);
      // (a^2 + b^2)(a + b) / 4 if both ends move in one direction, (a^4 + b^4)/(a + b) / 4 if not
      const V alike = (product + size_of_product) * (fma(w0, w0, w1 * w1) + size_of_product);
      const V inverse = 1.0 / (size0 + size1 + Constants<V>::of(1e-300));
      return Constants<V>::of(-0.75) * Constants<V>::of(minus_k) * ((fourth + alike) * inverse);
    }
  };

  template <class Row>
  void put(Law<Row>& law, int lane, const LinkConstants& on) const {
    const double k = 0.5 * air_density * drag_coefficient * diameter;
    set_lane(law.minus_k, lane, -k * on.length / 3.0);
    set_lane(law.minus_k_arm, lane, -k * on.length * on.length / 12.0);
    set_lane(law.wind_x, lane, wind[0]);
    set_lane(law.wind_y, lane, wind[1]);
  }
};

}  // namespace pendcore
