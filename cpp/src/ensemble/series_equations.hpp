/// \file
/// The forms of the equations whose Taylor series are computed in lanes: those of a single run
/// (dynamics/series), with a trajectory, and its constants, in each lane.
///
/// A form has, for a pack of trajectories: the number of `links`, or 0 if it is known at run time
/// and count() tells it; `block`, how many numbers of its state a single run takes at once, and
/// `place_of_rates`, the place of the first rate in its block; `One`, the constants of one
/// trajectory; one_of(), the constants of a scene, or nothing if its equations have another form;
/// prepare(), which sets the kinds of laws and gives lanes without a member numbers that do no
/// harm; put(), which puts constants into a lane and returns false if their laws are of other
/// kinds, so that the lane must not be used; set_order(), if it needs memory for the orders; and
/// expand(), which computes the series.
///
/// Here are the forms of a few links; chain_series_in_lanes.hpp has those of chains with any smooth
/// effects.
#pragma once

#include <optional>
#include <variant>

#include "dynamics/series/double_pendulum_series.hpp"
#include "dynamics/series/few_links_series.hpp"
#include "ensemble/lane_equations.hpp"

namespace pendcore {

/// The torques of couples and waves in lanes. `Row` is the row of a single run.
template <class Rows, class Row, class Real>
struct TorquesInLanes {
  using One = TorqueLaws<Row, double>;

  Couples<Rows> couples;
  TorqueLaws<Rows, Real> laws;

  TorquesInLanes() = default;
  TorquesInLanes(const TorquesInLanes&) = delete;  // its laws point to its own couples
  TorquesInLanes& operator=(const TorquesInLanes&) = delete;
  TorquesInLanes(TorquesInLanes&&) = delete;
  TorquesInLanes& operator=(TorquesInLanes&&) = delete;
  ~TorquesInLanes() = default;

  /// Sets the kinds of laws.
  void prepare(const One& one) {
    laws.couples = one.couples != nullptr ? &couples : nullptr;
    laws.has_powers = one.has_powers;
    laws.waves = one.waves;
  }
  bool put(int lane, const One& one) {
    const bool is_alike = (laws.couples != nullptr) == (one.couples != nullptr) &&
                          laws.has_powers == one.has_powers && laws.waves == one.waves;
    if (!is_alike) return false;
    if (one.couples != nullptr) put_constants(couples, lane, *one.couples);
    put_constants(laws, lane, one);
    return true;
  }
};

template <class Real>
struct BareDoublePendulumSeries {
  static constexpr int links = 2;
  static constexpr int block = 4;
  static constexpr int place_of_rates = 2;
  using One = DoublePendulumConstants;

  ConstantsOfDoublePendulum<Real> constants{};

  static std::optional<One> one_of(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    const auto series = bare_series(equations);
    return series ? std::optional(series->constants()) : std::nullopt;
  }
  void prepare(const One& /*one*/) { constants.delta = broadcast<Real>(1.0); }
  bool put(int lane, const One& one) {
    put_constants(constants, lane, one);
    return true;
  }
  PENDCORE_INLINE void expand(const Real& /*t*/, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    NoTorque none;
    expand_double_pendulum(constants, y, sigma, order, none, rows);
  }
};

template <class Real>
struct LoadedDoublePendulumSeries {
  static constexpr int links = 2;
  static constexpr int block = 4;
  static constexpr int place_of_rates = 2;
  struct One {
    DoublePendulumConstants constants;
    TorqueLaws<Pair, double> laws;
  };

  ConstantsOfDoublePendulum<Real> constants{};
  TorquesInLanes<Two<Real>, Pair, Real> torques;

  static std::optional<One> one_of(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    if (!equations.are_steady()) return std::nullopt;
    const auto series = series_with_torque(equations);
    return series ? std::optional(One{series->constants(), series->laws()}) : std::nullopt;
  }
  void prepare(const One& one) {
    constants.delta = broadcast<Real>(1.0);
    torques.prepare(one.laws);
  }
  bool put(int lane, const One& one) {
    put_constants(constants, lane, one.constants);
    return torques.put(lane, one.laws);
  }
  PENDCORE_INLINE void expand(const Real& t, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    TorqueOrders<Two<Real>, Real> orders(torques.laws, t, sigma);
    expand_double_pendulum(constants, y, sigma, order, orders, rows);
  }
};

template <class Real, int n>
struct FewLinksSeriesInLanes {
  static constexpr int links = n;
  static constexpr int block = 4;
  static constexpr int place_of_rates = 0;
  struct One {
    ConstantsOfFewLinks<double, n> constants;
    TorqueLaws<Pack<4>, double> laws;
  };

  ConstantsOfFewLinks<Real, n> constants{};
  TorquesInLanes<EachLink<Real, n>, Pack<4>, Real> torques;

  static std::optional<One> one_of(const Scene& scene, const EquationsOfMotion& equations) {
    if (scene.links.size() != n || !FewLinksSeries::has(scene, equations) ||
        !equations.are_steady()) {
      return std::nullopt;
    }
    One one{constants_of_few_links<n>(scene), {}};
    if (is_bare(scene)) return one;
    const auto& effects = dynamic_cast<const ActingEffects<Pack<4>>&>(*equations.effects);
    one.laws = torque_laws(effects, broadcast<Pack<4>>(1.0));
    return one;
  }
  void prepare(const One& one) {
    for (ChainLinkOf<Real>& link : constants.link) link.Io = broadcast<Real>(1.0);
    torques.prepare(one.laws);
  }
  bool put(int lane, const One& one) {
    put_constants(constants, lane, one.constants);
    return torques.put(lane, one.laws);
  }
  PENDCORE_INLINE void expand(const Real& t, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    expand_few_links<Real, n>(constants, torques.laws, t, y, sigma, order, rows);
  }
};
template <class Real>
using ThreeLinksSeries = FewLinksSeriesInLanes<Real, 3>;
template <class Real>
using FourLinksSeries = FewLinksSeriesInLanes<Real, 4>;

}  // namespace pendcore
