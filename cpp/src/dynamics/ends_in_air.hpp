/// \file
/// Where the air's drag on a rod has a kink: where an end of the rod turns into the wind or out of
/// it, the speed w across the rod changes its sign there (RodDragLaw). The third derivative of the
/// drag by the time jumps, the second one if the other end stands still.
///
///     w = n . (v - wind),   dw/dt = n . a - qd u . (v - wind)
///
/// v and a are the velocity and the acceleration of the end, u = (c, s) and n = (-s, c).
///
/// If the law went on beyond the kink as before it, the force on the rod would be wrong by
///
///     2/3 k L |w|^3 / (|w| + |w_other|)
///
/// Here w is the speed that the end reaches, and w_other that of the other end. This force, at most
/// the length away from the joint, acts for the shorter part of a step that a kink cuts in two, and
/// at least for as long as the first stage counts. By what it does to the rate of a rod that is not
/// connected to others, one knows whether the kink matters: in air that hardly moves, and near the
/// ends of a step, it does not.
///
/// Drag alone has kinks that no guard sees, so that this names the effect.
#pragma once

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
    for (Numbers* one : {&wind_x_, &wind_y_, &strength_, &allowed_}) {
      one->assign(link_of_rod_.size());
    }
  }
  /// Takes the tolerances of the state, (2n): kinks matter that are larger. It comes before put().
  void set_tolerances(const std::vector<double>& rtol, const std::vector<double>& atol) {
    rtol_.assign(rtol.begin() + links_, rtol.end());
    atol_.assign(atol.begin() + links_, atol.end());
  }
  /// Puts the constants of a scene into a lane.
  void put(const Scene& scene, int lane = 0) {
    for (int i = 0; i < links_; ++i) length_.put(i, lane, scene.links[i].length);
    int rod = 0;
    for (const RodDrag* drag : drags_by_link(scene)) {
      wind_x_.put(rod, lane, drag->wind[0]);
      wind_y_.put(rod, lane, drag->wind[1]);
      const Link& link = scene.links[drag->link - 1];
      const double inertia = link.inertia + link.mass * link.center * link.center;
      const double cube = link.length * link.length * link.length;
      strength_.put(rod, lane, 2.0 / 3.0 * drag->k() * cube / inertia);
      if (!atol_.empty()) allowed_.put(rod, lane, link.length * atol_[drag->link - 1]);
      ++rod;
    }
  }

  /// Whether speeds depend on the time, too.
  bool depend_on_time() const { return drives_ != nullptr && !drives_->pivots.empty(); }

  /// Two for each rod.
  int count() const { return 2 * static_cast<int>(link_of_rod_.size()); }

  /// The speeds of all ends at a state, and their slopes.
  struct Speeds {
    RowsInMemory<Number, Number> w, slope;  ///< m/s and m/s^2, of each end
  };
  Speeds room_for_speeds() const {
    Speeds room;
    room.w.assign(count());
    room.slope.assign(count());
    return room;
  }
  /// Computes them at a state (q, qd) with this derivative.
  PENDCORE_INLINE void find(const Number& t, const Number* y, const Number* dydt,
                            Speeds& found) const;
  /// The share of a step of size h at which its first kink lies that matters, or 1, from the speeds
  /// at its start and its end. An end that turns twice within a step is not noticed.
  PENDCORE_INLINE Number first_kink(const Number& h, const Speeds& first, const Speeds& last) const;

 private:
  using Numbers = RowsInMemory<Number, Number>;

  static std::vector<const RodDrag*> drags_by_link(const Scene& scene) {
    std::vector<const RodDrag*> drags;
    for (int link = 1; link <= static_cast<int>(scene.links.size()); ++link) {
      for (const RodDrag& drag : effects_of<RodDrag>(scene)) {
        if (drag.link == link) drags.push_back(&drag);
      }
    }
    return drags;
  }
  /// Whether an end has a kink within a step that matters.
  PENDCORE_INLINE Condition<Number> matters(int end, const Number& h, const Speeds& first,
                                            const Speeds& last) const;
  /// Where the cubic with these values, of two signs, and slopes at 0 and 1 is zero.
  PENDCORE_INLINE static Number share_of_zero(const Number& before, const Number& slope,
                                              const Number& after, const Number& last_slope);

  const Drives<Number>* drives_ = nullptr;
  int links_ = 0;
  std::vector<int> link_of_rod_;  ///< from 0, in their order
  Numbers length_, wind_x_, wind_y_;
  Numbers strength_;                 ///< 2/3 k L^3/I, 1/m, of each rod about its joint
  Numbers allowed_;                  ///< m/s, of a difference of speeds that is 0
  std::vector<double> rtol_, atol_;  ///< of the rate of each link
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
PENDCORE_INLINE Condition<Number> EndsInAir<Number>::matters(int end, const Number& h,
                                                             const Speeds& first,
                                                             const Speeds& last) const {
  constexpr double share = 0.1;  // of what the tolerances allow
  constexpr double weight_of_first_stage = 0.05;
  const int rod = end / 2;
  const int other = end ^ 1;
  const auto least = [&](int i) __attribute__((always_inline)) {
    const Number before = absolute(first.w[i]);
    const Number after = absolute(last.w[i]);
    return before < after ? before : after;
  };
  const Number turn_before = absolute(Number(first.w[end] - first.w[other]));
  const Number turn_after = absolute(Number(last.w[end] - last.w[other]));
  const Number turn = larger(turn_before, turn_after);
  const Number allowed = fma(broadcast<Number>(rtol_[link_of_rod_[rod]]), turn, allowed_[rod]);
  const Number whole = absolute(first.w[end]) + absolute(last.w[end]);
  const Number w = least(end);
  const Number wrong = fma(broadcast<Number>(weight_of_first_stage), whole, w);  // times h/whole
  return is_less(Number(share * (allowed * whole) * (w + least(other))),
                 Number(strength_[rod] * absolute(h) * (w * w * w) * wrong));
}

template <class Number>
PENDCORE_INLINE Number EndsInAir<Number>::first_kink(const Number& h, const Speeds& first,
                                                     const Speeds& last) const {
  const Number one = broadcast<Number>(1.0);
  Number nearest = one;
  for (int end = 0; end < count(); ++end) {
    const Number before = first.w[end];
    const Number after = last.w[end];
    const Condition<Number> turns = is_less(Number(before * after), Number{});
    if (!holds_somewhere(turns)) continue;
    const Condition<Number> counts = turns & matters(end, h, first, last);
    if (!holds_somewhere(counts)) continue;
    const Number zero = share_of_zero(before, h * first.slope[end], after, h * last.slope[end]);
    const Number share = counts ? zero : one;
    nearest = is_less(share, nearest) ? share : nearest;
  }
  // The loop would stretch a step that is hardly shorter than what is left (step_control.hpp).
  const Number most = broadcast<Number>(0.98);
  const Condition<Number> is_cut = is_less(nearest, one);
  return is_cut & is_less(most, nearest) ? most : nearest;
}

/// The same for a single run, compiled for this processor.
void find_speeds(const EndsInAir<double>& air, double t, const double* y, const double* dydt,
                 EndsInAir<double>::Speeds& found);

}  // namespace pendcore
