/// \file
/// The series of a double pendulum whose joints may be held. The closed form
/// (double_pendulum_series.hpp) gives it while both joints are free, the chain (chain_series.hpp)
/// while one is held.
#pragma once

#include <memory>
#include <utility>

#include "dynamics/series/chain_series_recurrence.hpp"
#include "dynamics/series/double_pendulum_series.hpp"
#include "dynamics/series/torque_series.hpp"

namespace pendcore {

class SeriesWithHolds {
 public:
  using Free = DoublePendulumSeries<CoupleTorque<Pair>>;
  using Block = Free::Block;
  static constexpr int blocks = Free::blocks;
  static constexpr bool is_short = false;
  static constexpr Sets sets = usual_sets;

  SeriesWithHolds(Free free, ChainSeries<Pair> held, std::shared_ptr<const EffectsOfRun> effects)
      : free_(std::move(free)), held_(std::move(held)), effects_(std::move(effects)) {}

  static constexpr int row() { return 2; }
  static constexpr int links() { return 2; }
  static constexpr bool depends_on_time() { return true; }
  void set_order(int order) { held_.set_order(order); }

  PENDCORE_INLINE void expand(double t, const double* y, double sigma, int order,
                              double* coefficients) const {
    if (effects_->any_held) {
      held_.expand(t, y, sigma, order, coefficients);
    } else {
      free_.expand(t, y, sigma, order, coefficients);
    }
  }

 private:
  Free free_;
  ChainSeries<Pair> held_;
  std::shared_ptr<const EffectsOfRun> effects_;
};

}  // namespace pendcore
