/// \file
/// The forms of the equations whose Taylor series are computed in lanes: those of a single run
/// (dynamics/series), with a trajectory, and its constants, in each lane.
///
/// A form has what lane_equations.hpp says, and, for a pack of trajectories: the number of `links`,
/// or 0 if it is known at run time and count() tells it; `block`, how many numbers of its state a
/// single run takes at once, and `place_of_rates`, the place of the first rate in its block;
/// set_order(), if it needs memory for the orders; and expand(), which computes the series.
#pragma once

#include <memory>
#include <type_traits>

#include "dynamics/series/chain_series_recurrence.hpp"
#include "dynamics/series/double_pendulum_series.hpp"
#include "dynamics/series/few_links_series.hpp"
#include "ensemble/lane_equations.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {

template <class Real>
struct BareDoublePendulumSeries {
  static constexpr int links = 2;
  static constexpr int block = 4;
  static constexpr int place_of_rates = 2;

  ConstantsOfDoublePendulum<Real> constants{};

  static bool has(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    return bare_series(equations).has_value();
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& /*one*/) {}
  void put(int lane, const Scene& /*scene*/, const EquationsOfMotion& one) {
    if (const auto series = bare_series(one)) put_constants(constants, lane, series->constants());
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

  ConstantsOfDoublePendulum<Real> constants{};
  EffectsInLanes<Two<Real>, Real> effects;
  Two<Real> factor{};

  static bool has(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    return equations.are_steady() && series_with_torque(equations).has_value();
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& one) {
    effects.prepare(effects_on<Pair>(one), links);
  }
  void put(int lane, const Scene& /*scene*/, const EquationsOfMotion& one) {
    if (const auto series = series_with_torque(one)) {
      put_constants(constants, lane, series->constants());
      put_number(factor, lane, series->torque().factor);
    }
    effects.put(lane, effects_on<Pair>(one));
  }
  PENDCORE_INLINE void expand(const Real& t, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    const auto laws = torque_laws(effects, factor);
    TorqueOrders<Two<Real>, Real> orders(laws, t, sigma);
    expand_double_pendulum(constants, y, sigma, order, orders, rows);
  }
};

template <class Real, int n>
struct FewLinksSeriesInLanes {
  static constexpr int links = n;
  static constexpr int block = 4;
  static constexpr int place_of_rates = 0;
  using Row = EachLink<Real, n>;

  ConstantsOfFewLinks<Real, n> constants{};
  EffectsInLanes<Row, Real> effects;

  static bool has(const Scene& scene, const EquationsOfMotion& equations) {
    return scene.links.size() == n && equations.are_steady() &&
           FewLinksSeries::has(scene, equations);
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& one) {
    effects.prepare(effects_on<Pack<4>>(one), n);
  }
  void put(int lane, const Scene& scene, const EquationsOfMotion& one) {
    put_constants(constants, lane, constants_of_few_links<n>(scene));
    effects.put(lane, effects_on<Pack<4>>(one));
  }
  PENDCORE_INLINE void expand(const Real& t, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    const auto laws = torque_laws(effects, Constants<Row>::of(1.0));
    expand_few_links<Real, n>(constants, laws, t, y, sigma, order, rows);
  }
};

/// A chain with any smooth effects, for what the other forms do not have. `n` is the number of its
/// links, or 0 for any number from three on, which is known at run time.
template <class Real, int n>
class ChainSeriesInLanes {
 public:
  static constexpr int links = n;
  static constexpr int block = n == 2 ? 2 : 4;
  static constexpr int place_of_rates = 0;
  using Effects = EffectsInLanes<Real, Real>;
  using RowOfRun = std::conditional_t<n == 2, Pair, Pack<4>>;

  static bool has(const Scene& scene, const EquationsOfMotion& equations) {
    const int count = static_cast<int>(scene.links.size());
    return (n == 0 ? count >= 3 : count == n) && equations.effects && equations.are_steady() &&
           !without_series(scene);
  }
  int count() const { return series_->links(); }
  void prepare(const Scene& scene, const EquationsOfMotion& one) {
    const int count = static_cast<int>(scene.links.size());
    effects_->prepare(effects_on<RowOfRun>(one), count);
    ConstantsOfChain<Real> constants(count);
    constants.put(0, ConstantsOfChain<double>(scene));  // say whether there are rotors
    series_ = std::make_unique<ChainSeries<Real, Effects>>(std::move(constants), effects_);
  }
  void set_order(int order) { series_->set_order(order); }
  void put(int lane, const Scene& scene, const EquationsOfMotion& one) {
    series_->constants().put(lane, ConstantsOfChain<double>(scene));
    effects_->put(lane, effects_on<RowOfRun>(one));
  }
  PENDCORE_INLINE void expand(const Real& t, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    series_->expand(t, y, sigma, order, rows);
  }

 private:
  std::shared_ptr<Effects> effects_ = std::make_shared<Effects>();
  std::unique_ptr<ChainSeries<Real, Effects>> series_;
};

}  // namespace pendcore
