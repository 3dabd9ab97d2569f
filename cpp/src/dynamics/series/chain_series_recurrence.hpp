/// \file
/// The recurrences of chain_series.hpp.
#pragma once

#include <type_traits>
#include <utility>

#include "arithmetic/power.hpp"
#include "dynamics/series/chain_series.hpp"

namespace pendcore {

namespace chain_series_detail {
inline constexpr int margin = 4;  ///< numbers before and after those of the joints
}  // namespace chain_series_detail

template <class Row, class Effects>
ChainSeries<Row, Effects>::ChainSeries(ConstantsOfChain<Number> constants,
                                       std::shared_ptr<const Effects> effects)
    : n_(constants.links()),
      row_((n_ + places - 1) / places * places),
      groups_(row_ / places),
      constants_(std::move(constants)),
      has_rotors_(constants_.has_rotors()),
      effects_(std::move(effects)),
      factors_(n_),
      passing_(n_) {
  for (Rows* rows : {&beta_x_, &beta_y_, &torque_, &alpha_, &hx_, &hy_}) rows->assign(row_);
  const std::size_t room = row_ + 2 * static_cast<std::size_t>(chain_series_detail::margin);
  for (Rows* rows : {&couple_, &angle_, &speed_}) rows->assign(room);
}

template <class Row, class Effects>
void ChainSeries<Row, Effects>::set_order(int order) {
  room_ = (static_cast<std::ptrdiff_t>(order) + 3) * places;
  series_.assign(static_cast<std::size_t>(groups_) * quantities * room_);
}

/// Computes the factors of chain.hpp's recursion without loads. B is in the frame of each link;
/// what is kept is along x and y.
template <class Row, class Effects>
PENDCORE_INLINE void ChainSeries<Row, Effects>::factor() const {
  const bool coupled = has_rotors_ || (effects_ && effects_->any_held);
  const Number payload_mass = constants_.payload_mass();
  ForcePerAcceleration<Number> B{payload_mass, Number{}, payload_mass};
  Number fu{};
  Number fn{};
  Number kappa{};
  for (int i = n_ - 1; i >= 0; --i) {
    const ChainLinkOf<Number> k = constants_.link(i);
    const Number c = order_zero_of(cosine_of, i);
    const Number s = order_zero_of(sine_of, i);
    Factors& here = factors_[i];
    here.nx = -s;
    here.ny = c;
    here.Bxx = fma(c * c, B.uu, fma(-2.0 * c * s, B.un, s * s * B.nn));
    here.Byy = fma(s * s, B.uu, fma(2.0 * c * s, B.un, c * c * B.nn));
    here.Bxy = fma(c * s, B.uu - B.nn, (c * c - s * s) * B.un);
    here.fx = fma(fu, c, -(fn * s));
    here.fy = fma(fu, s, fn * c);
    const Number D = fma(k.LL, B.nn, k.Io) + fma(2.0 * k.L, fn, kappa);
    const Number wu = fma(k.L, B.un, fu);
    const Number wn = fma(k.L, B.nn, k.mc) + fn;
    const bool is_held = effects_ && effects_->held[i];
    const Number rotor = constants_.rotor(i);
    here.r = is_held ? Number{} : Number(1.0 / (D + rotor));
    here.s = is_held ? broadcast<Number>(1.0) : Number(rotor * here.r);
    here.wx = fma(wu, c, -(wn * s));
    here.wy = fma(wu, s, wn * c);
    if (i == 0) break;
    const Number c_before = order_zero_of(cosine_of, i - 1);
    const Number s_before = order_zero_of(sine_of, i - 1);
    const Number cos = fma(c, c_before, s * s_before);
    const Number sin = fma(s, c_before, -(c * s_before));
    const Number cc = cos * cos;
    const Number ss = sin * sin;
    const Number sc = sin * cos;
    if (!coupled) {
      B.add_free(k, here.r, wu, cc, ss, sc);
    } else {
      B.add_coupled(k, here.r, wu, wn, cc, ss, sc);
      fu = here.s * fma(wu, cos, -(wn * sin));
      fn = here.s * fma(wu, sin, wn * cos);
      kappa = here.s * D;
    }
  }
}

/// Takes the waves sin(phase + omega sigma theta) from order k to the next.
template <class Row, class Effects>
PENDCORE_INLINE void ChainSeries<Row, Effects>::advance_waves(const Time& sigma, int k) const {
  if (!effects_) return;
  for (int i = 0; i < effects_->waves; ++i) {
    const Number factor = inverse_of[k + 1] * (sigma * effects_->angular_frequency[i]);
    const Number sine = effects_->wave_sine[i];
    effects_->wave_sine.set(i, factor * effects_->wave_cosine[i]);
    effects_->wave_cosine.set(i, -(factor * sine));
  }
}

template <class Row, class Effects>
PENDCORE_INLINE void ChainSeries<Row, Effects>::pivot_acceleration(const Time& t, const Time& sigma,
                                                                   int k, Number& x,
                                                                   Number& y) const {
  x = Number{};
  y = k == 0 ? Number(-(sigma * sigma * constants_.gravity())) : Number{};
  if (!effects_) return;
  for (const PivotLawOf<Number>& law : effects_->pivots) {
    const auto along = [&](const auto& axis) __attribute__((always_inline)) {
      const Number of_piece = k == 0   ? fma(axis.slope, Number(t - law.start), axis.held)
                              : k == 1 ? Number(sigma * axis.slope)
                                       : Number{};
      return Number(sigma * sigma * fma(axis.gain, effects_->wave_sine[axis.wave], of_piece));
    };
    x += along(law.x);
    y += along(law.y);
  }
}

/// Adds the torques of the effects, order k, from angle_ and speed_ of that order.
template <class Row, class Effects>
PENDCORE_INLINE void ChainSeries<Row, Effects>::add_couples(const Time& t, const Time& sigma,
                                                            int k) const {
  constexpr int margin = chain_series_detail::margin;
  if (!effects_ || (effects_->couples.empty() && effects_->joint_waves.empty())) return;
  for (int i = 0; i < row_; i += places) couple_.set_row(margin + i, Row{});
  const Time square = sigma * sigma;
  const Time per_sigma = inverse_of_power_of_two(sigma);
  for (const Couples<Row>& one : effects_->couples) {
    const int at = margin + one.row * places;
    const Row phi = angle_.row(at) - angle_.row(at - 1);
    const Row w = speed_.row(at) - speed_.row(at - 1);
    Row torque = fma(Row(square * one.on_phi), phi, Row(sigma * one.on_phid * w));
    if (k == 0) torque = torque + square * one.template in_time<Row>(t);
    if (k == 1) torque = torque + square * sigma * one.slope;
    if (one.has_powers) {
      const int row = one.row;
      const auto rate = [this, row](int j) __attribute__((always_inline)) {
        return order_of(relative_of, row, j);
      };
      const auto square_of_rate = [this, row](int j) __attribute__((always_inline)) {
        return order_of(square_of, row, j);
      };
      set_order_of(relative_of, row, k, w);
      const Row w2 = order_of_product(k, rate, rate);
      set_order_of(square_of, row, k, w2);
      const Row w3 = order_of_product(k, square_of_rate, rate);
      torque = fma(one.on_phid2, w2, fma(Row(per_sigma * one.on_phid3), w3, torque));
    }
    couple_.set_row(at, torque);
  }
  for (const JointWaveOf<Number>& one : effects_->joint_waves) {
    const int at = margin + one.joint;
    const Number driven = sigma * sigma * one.gain * effects_->wave_sine[one.wave];
    couple_.set(at, couple_[at] + driven);
  }
  for (int i = 0; i < row_; i += places) {
    const Row difference = couple_.row(margin + i) - couple_.row(margin + i + 1);
    torque_.set_row(i, torque_.row(i) + difference);
  }
}

/// Computes alpha and H of every link from the torques, beta, and the acceleration of the pivot.
template <class Row, class Effects>
PENDCORE_INLINE void ChainSeries<Row, Effects>::solve(Number ax, Number ay) const {
  Number bx{};
  Number by{};
  Number t{};
  for (int i = n_ - 1; i >= 0; --i) {
    const ChainLinkOf<Number> k = constants_.link(i);
    const Factors& here = factors_[i];
    const Number x = beta_x_[i];
    const Number y = beta_y_[i];
    const Number px = fma(k.L, fma(here.Bxx, x, here.Bxy * y), bx);
    const Number py = fma(k.L, fma(here.Bxy, x, here.Byy * y), by);
    const Number of_beta = fma(k.L, fma(here.fx, x, here.fy * y), t);
    const Number torque = torque_[i] - fma(k.L, fma(here.nx, px, here.ny * py), of_beta);
    const Number free = here.r * torque;
    passing_[i] = {bx, by, t, free};
    bx = fma(here.wx, free, fma(k.mc, x, px));
    by = fma(here.wy, free, fma(k.mc, y, py));
    t = -(here.s * torque);
  }
  Number before{};
  for (int i = 0; i < n_; ++i) {
    const ChainLinkOf<Number> k = constants_.link(i);
    const Factors& here = factors_[i];
    const Passing& passing = passing_[i];
    const Number alpha =
        fma(here.s, before, fma(-here.r, fma(here.wx, ax, here.wy * ay), passing.free));
    const Number x = fma(k.L, fma(alpha, here.nx, beta_x_[i]), ax);
    const Number y = fma(k.L, fma(alpha, here.ny, beta_y_[i]), ay);
    const Number force_x = fma(here.fx, alpha, fma(here.Bxx, x, fma(here.Bxy, y, passing.bx)));
    const Number force_y = fma(here.fy, alpha, fma(here.Bxy, x, fma(here.Byy, y, passing.by)));
    hx_.set(i, fma(k.mc, ax, Number(k.L * force_x)));
    hy_.set(i, fma(k.mc, ay, Number(k.L * force_y)));
    before = alpha;
    alpha_.set(i, alpha);
    ax = x;
    ay = y;
  }
}

template <class Row, class Effects>
PENDCORE_INLINE void ChainSeries<Row, Effects>::expand(const Time& t, const Number* y,
                                                       const Time& sigma, int order,
                                                       Number* coefficients) const {
  constexpr int margin = chain_series_detail::margin;
  // Numbers side by side make a row; in lanes, or with slopes, one number does.
  constexpr bool have_slopes = !std::is_same_v<Number, Time>;
  const auto row_at = [](const Number* from) __attribute__((always_inline)) {
    if constexpr (have_slopes) {
      return *from;
    } else {
      Row x;
      __builtin_memcpy(&x, from, sizeof x);
      return x;
    }
  };
  const auto put_row = [](Number* to, const Row& x) __attribute__((always_inline)) {
    if constexpr (have_slopes) {
      *to = x;
    } else {
      __builtin_memcpy(to, &x, sizeof x);
    }
  };
  const Time per_sigma = inverse_of_power_of_two(sigma);
  for (int g = 0; g < groups_; ++g) {
    const int at = g * places;
    Row s, c;
    sine_cosine(row_at(y + at), s, c);
    const Row w = sigma * row_at(y + row_ + at);
    set_order_of(cosine_of, g, 0, c);
    set_order_of(sine_of, g, 0, s);
    set_order_of(rate_of, g, 0, w);
    set_order_of(cosine_of, g, 1, -(w * s));
    set_order_of(sine_of, g, 1, w * c);
    angle_.set_row(margin + at, row_at(y + at));
    speed_.set_row(margin + at, w);
  }
  factor();
  if (effects_) effects_->compute_waves(t, 0);

  for (int k = 0; k < order; ++k) {
    const double next = k + 1.0;
    for (int g = 0; g < groups_; ++g) {
      Row along_x{}, along_y{}, by_x{}, by_y{};
      for (int j = 0; j < k; ++j) {
        const Row c_j = order_of(cosine_of, g, k - j);
        const Row s_j = order_of(sine_of, g, k - j);
        const Row w_j = order_of(rate_of, g, j + 1);
        along_x = fma(w_j, s_j, along_x);
        along_y = fma(w_j, c_j, along_y);
        by_x = fma(order_of(hx_of, g, j), s_j, by_x);
        by_y = fma(order_of(hy_of, g, j), c_j, by_y);
      }
      const Row w_0 = order_of(rate_of, g, 0);
      along_x = fma(w_0, order_of(sine_of, g, k + 1), along_x);
      along_y = fma(w_0, order_of(cosine_of, g, k + 1), along_y);
      beta_x_.set_row(g * places, -next * along_x);
      beta_y_.set_row(g * places, next * along_y);
      torque_.set_row(g * places, by_x - by_y);
    }
    add_couples(t, sigma, k);
    Number ax, ay;
    pivot_acceleration(t, sigma, k, ax, ay);
    advance_waves(sigma, k);
    solve(ax, ay);
    Number* const row = coefficients + static_cast<std::ptrdiff_t>(k + 1) * 2 * row_;
    for (int g = 0; g < groups_; ++g) {
      const int at = g * places;
      const Row alpha = alpha_.row(at);
      const Row q_next = inverse_of[k + 1] * order_of(rate_of, g, k);
      const Row w_next = inverse_of[k + 1] * alpha;
      const double share = inverse_of[k + 1] * inverse_of[k + 2];
      const Row s = order_of(sine_of, g, 0);
      const Row c = order_of(cosine_of, g, 0);
      set_order_of(cosine_of, g, k + 2, share * fma(Row(-alpha), s, beta_x_.row(at)));
      set_order_of(sine_of, g, k + 2, share * fma(alpha, c, beta_y_.row(at)));
      set_order_of(rate_of, g, k + 1, w_next);
      set_order_of(hx_of, g, k, hx_.row(at));
      set_order_of(hy_of, g, k, hy_.row(at));
      put_row(row + at, q_next);
      put_row(row + row_ + at, per_sigma * w_next);
      angle_.set_row(margin + at, q_next);
      speed_.set_row(margin + at, w_next);
    }
  }
}

}  // namespace pendcore
