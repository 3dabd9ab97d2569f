/// \file
/// Where the air's drag on a rod has a kink: where an end of the rod turns into the wind or out of
/// it, the speed w across the rod changes its sign there (RodDragLaw). The third derivative of the
/// drag by the time jumps, the second one if the other end stands still.
///
///     w = n . (v - wind),   dw/dt = n . a - qd u . (v - wind)
///
/// v and a are the velocity and the acceleration of the end, u = (c, s) and n = (-s, c).
#pragma once

#include <algorithm>
#include <vector>

#include "arithmetic/pack.hpp"
#include "arithmetic/rows_in_memory.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/drives.hpp"
#include "pendcore/effects/rod_drag.hpp"
#include "scene/effects_of_scene.hpp"

namespace pendcore {

/// The ends of the rods on which air acts. `Number` is a double, or a pack with a trajectory in
/// each lane.
template <class Number>
class EndsInAir {
 public:
  /// Makes room for the rods of a scene. `drives`, which move the pivot, must stay where they are;
  /// they may be null without effects.
  void prepare(const Scene& scene, const Drives<Number>* drives) {
    drives_ = drives;
    link_of_rod_.clear();
    for (const RodDrag* drag : drags_by_link(scene)) link_of_rod_.push_back(drag->link - 1);
    links_ = static_cast<int>(scene.links.size());
    length_.assign(scene.links.size());
    for (Numbers* one : {&wind_x_, &wind_y_}) one->assign(link_of_rod_.size());
  }
  /// Puts the constants of a scene into a lane.
  void put(const Scene& scene, int lane = 0) {
    for (int i = 0; i < links_; ++i) length_.put(i, lane, scene.links[i].length);
    int rod = 0;
    for (const RodDrag* drag : drags_by_link(scene)) {
      wind_x_.put(rod, lane, drag->wind[0]);
      wind_y_.put(rod, lane, drag->wind[1]);
      ++rod;
    }
  }

  /// Whether speeds depend on the time, too.
  bool depend_on_time() const { return drives_ != nullptr && !drives_->pivots.empty(); }

  /// Two for each rod.
  int count() const { return 2 * static_cast<int>(link_of_rod_.size()); }

  /// What is known of the ends at a state.
  struct Speeds {
    RowsInMemory<Number, Number> w, slope;  ///< m/s and m/s^2, of each end
  };
  Speeds speeds() const {
    Speeds room;
    room.w.assign(count());
    room.slope.assign(count());
    return room;
  }
  /// Computes them at a state (q, qd) with this derivative.
  PENDCORE_INLINE void find(const Number& t, const Number* y, const Number* dydt,
                            Speeds& found) const;
  /// The share of a step of size h at which its first kink lies, or 1, from the speeds at its start
  /// and its end. Kinks in the first and the last hundredth of a step do not count, and an
  /// end that turns twice within a step is not noticed.
  PENDCORE_INLINE Number first_kink(const Number& h, const Speeds& start, const Speeds& end) const;

 private:
  using Numbers = RowsInMemory<Number, Number>;

  static std::vector<const RodDrag*> drags_by_link(const Scene& scene) {
    std::vector<const RodDrag*> drags;
    for (const RodDrag& drag : effects_of<RodDrag>(scene)) drags.push_back(&drag);
    std::ranges::stable_sort(drags, {}, &RodDrag::link);
    return drags;
  }
  /// Where the cubic with these values, of two signs, and slopes at 0 and 1 is zero.
  PENDCORE_INLINE static Number share_of_zero(const Number& before, const Number& slope,
                                              const Number& after, const Number& last_slope);

  const Drives<Number>* drives_ = nullptr;
  int links_ = 0;
  std::vector<int> link_of_rod_;  ///< from 0, in their order
  Numbers length_, wind_x_, wind_y_;
};

template <class Number>
PENDCORE_INLINE void EndsInAir<Number>::find(const Number& t, const Number* y, const Number* dydt,
                                             Speeds& found) const {
  Number vx{}, vy{}, ax{}, ay{};
  if (depend_on_time()) {
    drives_->compute_waves(t, 0);
    drives_->pivot_velocity(t, vx, vy);
    drives_->pivot_acceleration(t, ax, ay);
  }
  const int rods = static_cast<int>(link_of_rod_.size());
  int rod = 0;
  for (int i = 0; rod < rods; ++i) {
    Number s, c;
    sine_cosine(y[i], s, c);
    const Number rate = y[links_ + i];
    const Number across = length_[i] * rate;
    const Number turn = across * rate;
    const Number along_n = length_[i] * dydt[links_ + i];
    const Number far_vx = fma(Number(-s), across, vx);
    const Number far_vy = fma(c, across, vy);
    const Number far_ax = ax - fma(s, along_n, c * turn);
    const Number far_ay = ay + fma(c, along_n, Number(-(s * turn)));
    for (; rod < rods && link_of_rod_[rod] == i; ++rod) {
      const auto put = [&](int end, const Number& end_vx, const Number& end_vy,
                           const Number& end_ax, const Number& end_ay)
                           __attribute__((always_inline)) {
                             const Number x = end_vx - wind_x_[rod];
                             const Number y_down = end_vy - wind_y_[rod];
                             found.w.set(end, fma(c, y_down, Number(-(s * x))));
                             const Number of_end = fma(c, end_ay, Number(-(s * end_ax)));
                             const Number along = fma(c, x, s * y_down);
                             found.slope.set(end, fma(Number(-rate), along, of_end));
                           };
      put(2 * rod, vx, vy, ax, ay);
      put(2 * rod + 1, far_vx, far_vy, far_ax, far_ay);
    }
    vx = far_vx;
    vy = far_vy;
    ax = far_ax;
    ay = far_ay;
  }
}

template <class Number>
PENDCORE_INLINE Number EndsInAir<Number>::share_of_zero(const Number& before, const Number& slope,
                                                        const Number& after,
                                                        const Number& last_slope) {
  const Number rise = after - before;
  const Number square = 3.0 * rise - (slope + slope) - last_slope;
  const Number cube = slope + last_slope - (rise + rise);
  const Number by_line = -(before / rise);
  Number x = by_line;
  for (int k = 0; k < 2; ++k) {  // Newton's
    const Number value = fma(x, fma(x, fma(x, cube, square), slope), before);
    x = x - value / fma(x, fma(x, 3.0 * cube, square + square), slope);
  }
  const Condition<Number> is_within = is_less(Number{}, x) & is_less(x, broadcast<Number>(1.0));
  return is_within ? x : by_line;
}

template <class Number>
PENDCORE_INLINE Number EndsInAir<Number>::first_kink(const Number& h, const Speeds& start,
                                                     const Speeds& end) const {
  constexpr double near_an_end = 0.01;  // across it, a step errs by less than a thousandth
  const Number one = broadcast<Number>(1.0);
  Number first = one;
  for (int i = 0; i < count(); ++i) {
    const Number before = start.w[i];
    const Number after = end.w[i];
    const Condition<Number> turns = is_less(Number(before * after), Number{});
    if (!holds_somewhere(turns)) continue;
    const Number zero = share_of_zero(before, h * start.slope[i], after, h * end.slope[i]);
    const Condition<Number> counts = turns & is_less(broadcast<Number>(near_an_end), zero);
    const Number share = counts ? zero : one;
    first = is_less(share, first) ? share : first;
  }
  return is_less(broadcast<Number>(1.0 - near_an_end), first) ? one : first;
}

}  // namespace pendcore
