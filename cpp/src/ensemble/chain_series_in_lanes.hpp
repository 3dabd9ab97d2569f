/// \file
/// The Taylor series of a chain with any smooth effects in lanes (series_equations.hpp): the
/// recurrences of chain_series.hpp, with a trajectory in each lane.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "dynamics/equations_of_motion.hpp"
#include "dynamics/series/chain_series_recurrence.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {

/// The effects of a chain in each lane. Their laws are of the same kinds in all lanes.
template <class Real>
class EffectsOfChainInLanes {
 public:
  using Number = Real;
  /// Those of one trajectory.
  struct One {
    std::vector<double> angular_frequency, phase;  ///< of each wave
    std::vector<JointWaveOf<double>> joint_waves;
    struct Pivot {
      double start;
      PivotAxisOf<double> x, y;
    };
    std::vector<Pivot> pivots;
    /// The couple of one joint. A joint without any has one, too, if it is in the row of another's:
    /// a single run computes all joints of a row.
    struct Joint {
      Couples<double> couples;
      bool has_powers;
    };
    std::vector<Joint> joints;

    template <class Row>
    One(const ActingEffects<Row>& effects, int links);
    bool is_like(const One& other) const;
  };

  explicit EffectsOfChainInLanes(const One& one);
  void put(int lane, const One& one);
  /// One whose laws are of the kinds of all.
  const One& kinds() const { return kinds_; }

  static constexpr bool are_any() { return true; }
  static constexpr bool any_held() { return false; }
  static constexpr bool is_held(int /*joint*/) { return false; }

  int waves() const { return static_cast<int>(kinds_.phase.size()); }
  PENDCORE_INLINE Real angular_frequency(int wave) const { return angular_frequency_.number(wave); }
  PENDCORE_INLINE void compute_waves(const Real& t, RowsInMemory<Real, Real>& sine,
                                     RowsInMemory<Real, Real>& cosine) const {
    for (int k = 0; k < waves(); ++k) {
      Real s, c;
      sine_cosine(fma(angular_frequency_.number(k), t, phase_.number(k)), s, c);
      sine.set(k, s);
      cosine.set(k, c);
    }
  }

  int pivots() const { return static_cast<int>(kinds_.pivots.size()); }
  PENDCORE_INLINE Real start_of_pivot(int i) const { return pivot_.number(numbers_of_pivot * i); }
  PENDCORE_INLINE PivotAxisOf<Real> pivot_x(int i) const {
    return axis(kinds_.pivots[i].x.wave, i, 1);
  }
  PENDCORE_INLINE PivotAxisOf<Real> pivot_y(int i) const {
    return axis(kinds_.pivots[i].y.wave, i, 4);
  }

  int couples() const { return static_cast<int>(couples_.size()); }
  const Couples<Real>& couple(int i) const { return couples_[i]; }
  bool has_powers(int i) const { return kinds_.joints[i].has_powers; }
  int joint_waves() const { return static_cast<int>(kinds_.joint_waves.size()); }
  PENDCORE_INLINE JointWaveOf<Real> joint_wave(int i) const {
    const JointWaveOf<double>& one = kinds_.joint_waves[i];
    return {one.joint, one.wave, gain_.number(i)};
  }

 private:
  static constexpr std::ptrdiff_t numbers_of_pivot = 7;
  PENDCORE_INLINE PivotAxisOf<Real> axis(int wave, int i, int first) const {
    const std::ptrdiff_t at = numbers_of_pivot * i + first;
    return {wave, pivot_.number(at), pivot_.number(at + 1), pivot_.number(at + 2)};
  }

  One kinds_;
  RowsInMemory<Real, Real> angular_frequency_, phase_, gain_, pivot_;
  std::vector<Couples<Real>> couples_;
};

template <class Real>
template <class Row>
EffectsOfChainInLanes<Real>::One::One(const ActingEffects<Row>& effects, int links)
    : angular_frequency(effects.angular_frequency.begin(),
                        effects.angular_frequency.begin() + effects.waves),
      phase(effects.phase.begin(), effects.phase.begin() + effects.waves) {
  for (const JointWave& wave : effects.joint_waves) {
    joint_waves.push_back({wave.joint, wave.wave, wave.gain});
  }
  for (const PivotLaw& law : effects.pivots) {
    pivots.push_back({law.start, axis_of(law.x), axis_of(law.y)});
  }
  constexpr int places = Lanes<Row>::width;
  for (const Couples<Row>& of_row : effects.couples) {
    for (int i = 0; i < places && of_row.row * places + i < links; ++i) {
      Couples<double> joint;
      joint.row = of_row.row * places + i;
      each_field(joint, of_row, [i](double& to, const Row& row) { to = lane(row, i); });
      joints.push_back({joint, of_row.has_powers()});
    }
  }
}

template <class Real>
bool EffectsOfChainInLanes<Real>::One::is_like(const One& other) const {
  const auto same_wave = [](const auto& a, const auto& b) { return a.wave == b.wave; };
  return phase.size() == other.phase.size() &&
         std::ranges::equal(
             joint_waves, other.joint_waves,
             [&](const auto& a, const auto& b) { return a.joint == b.joint && same_wave(a, b); }) &&
         std::ranges::equal(pivots, other.pivots,
                            [&](const Pivot& a, const Pivot& b) {
                              return same_wave(a.x, b.x) && same_wave(a.y, b.y);
                            }) &&
         std::ranges::equal(joints, other.joints, [](const Joint& a, const Joint& b) {
           return a.couples.row == b.couples.row && a.has_powers == b.has_powers;
         });
}

template <class Real>
EffectsOfChainInLanes<Real>::EffectsOfChainInLanes(const One& one)
    : kinds_(one), couples_(one.joints.size()) {
  angular_frequency_.assign(one.phase.size());
  phase_.assign(one.phase.size());
  gain_.assign(one.joint_waves.size());
  pivot_.assign(numbers_of_pivot * one.pivots.size());
  for (std::size_t i = 0; i < one.joints.size(); ++i) couples_[i].row = one.joints[i].couples.row;
}

template <class Real>
void EffectsOfChainInLanes<Real>::put(int lane, const One& one) {
  for (int k = 0; k < waves(); ++k) {
    angular_frequency_.put(k, lane, one.angular_frequency[k]);
    phase_.put(k, lane, one.phase[k]);
  }
  for (int i = 0; i < joint_waves(); ++i) gain_.put(i, lane, one.joint_waves[i].gain);
  for (int i = 0; i < pivots(); ++i) {
    const auto& [start, x, y] = one.pivots[i];
    std::ptrdiff_t at = numbers_of_pivot * i;
    for (const double number : {start, x.held, x.slope, x.gain, y.held, y.slope, y.gain}) {
      pivot_.put(at++, lane, number);
    }
  }
  for (int i = 0; i < couples(); ++i) {
    each_field(couples_[i], one.joints[i].couples,
               [lane](Real& all, double number) { set_lane(all, lane, number); });
  }
}

/// A chain with smooth effects, for what the forms of series_equations.hpp do not have. `n` is the
/// number of its links, or 0 for any number from three on, which is known at run time.
template <class Real, int n>
class ChainSeriesInLanes {
 public:
  static constexpr int links = n;
  static constexpr int block = n == 2 ? 2 : 4;
  static constexpr int place_of_rates = 0;
  using Effects = EffectsOfChainInLanes<Real>;
  using Series = ChainSeries<Real, Effects>;
  struct One {
    ConstantsOfChain<double> constants;
    typename Effects::One effects;
  };

  static std::optional<One> one_of(const Scene& scene, const EquationsOfMotion& equations) {
    const int count = static_cast<int>(scene.links.size());
    const bool has_right_count = n == 0 ? count >= 3 : count == n;
    if (!has_right_count || !equations.effects || without_series(scene) ||
        !equations.are_steady()) {
      return std::nullopt;
    }
    using Row = std::conditional_t<n == 2, Pair, Pack<4>>;
    const auto& effects = dynamic_cast<const ActingEffects<Row>&>(*equations.effects);
    return One{ConstantsOfChain<double>(scene), {effects, count}};
  }
  int count() const { return series_->links(); }
  /// All lanes have the constants of the given trajectory until others are put.
  void prepare(const One& one) {
    const int count = one.constants.links();
    ConstantsOfChain<Real> constants(count);
    for (int lane = 0; lane < Lanes<Real>::width; ++lane) constants.put(lane, one.constants);
    series_ = std::make_unique<Series>(count, std::move(constants), Effects(one.effects));
    for (int lane = 0; lane < Lanes<Real>::width; ++lane) series_->effects().put(lane, one.effects);
  }
  void set_order(int order) { series_->set_order(order); }
  bool put(int lane, const One& one) {
    const bool is_alike = one.effects.is_like(series_->effects().kinds()) &&
                          one.constants.has_rotors() == series_->has_rotors();
    if (!is_alike) return false;
    series_->constants().put(lane, one.constants);
    series_->effects().put(lane, one.effects);
    return true;
  }
  PENDCORE_INLINE void expand(const Real& t, const Real* y, const Real& sigma, int order,
                              Real* rows) const {
    series_->expand(t, y, sigma, order, rows);
  }

 private:
  std::unique_ptr<Series> series_;
};
template <class Real>
using ChainOfTwo = ChainSeriesInLanes<Real, 2>;
template <class Real>
using LongerChain = ChainSeriesInLanes<Real, 0>;

}  // namespace pendcore
