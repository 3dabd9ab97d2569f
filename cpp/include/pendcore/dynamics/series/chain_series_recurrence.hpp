/// \file
/// The recurrences of chain_series.hpp.
#pragma once

#include <algorithm>

#include "pendcore/dynamics/series/chain_series.hpp"

namespace pendcore {

namespace chain_series_detail {
inline constexpr int margin = 4;  ///< numbers before and after those of the joints
}

template <class Row>
ChainSeries<Row>::ChainSeries(const Scene& scene, std::shared_ptr<const ActingEffects<Row>> effects)
    : n_(static_cast<int>(scene.links.size())),
      row_((n_ + width - 1) / width * width),
      groups_(row_ / width),
      gravity_(scene.gravity),
      payload_mass_(0.0),
      effects_(std::move(effects)),
      factors_(n_),
      passing_(n_) {
  const Inertia inertia(scene);
  payload_mass_ = inertia.payload_mass;
  links_ = chain_links(scene, inertia);
  rotor_ = inertia.rotors_between_links();
  has_rotors_ = std::ranges::any_of(rotor_, [](double J) { return J > 0.0; });
  for (auto* array : {&beta_x_, &beta_y_, &torque_, &alpha_, &hx_, &hy_}) array->resize(row_);
  const std::size_t room = row_ + 2 * static_cast<std::size_t>(chain_series_detail::margin);
  for (auto* array : {&couple_, &angle_, &speed_}) array->resize(room);
  if (effects_) {
    wave_sine_.resize(effects_->waves + 1);
    wave_cosine_.resize(effects_->waves + 1);
  }
}

template <class Row>
void ChainSeries<Row>::set_order(int order) {
  room_ = (static_cast<std::size_t>(order) + 3) * width;
  series_.assign(static_cast<std::size_t>(groups_) * quantities * room_, 0.0);
}

/// Computes the factors of chain.hpp's recursion without loads. B is in the frame of each link;
/// what is kept is along x and y.
template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::factor() const {
  const bool coupled = has_rotors_ || (effects_ && effects_->any_held);
  ForcePerAcceleration<double> B{payload_mass_, 0.0, payload_mass_};
  double fu = 0.0;
  double fn = 0.0;
  double kappa = 0.0;
  for (int i = n_ - 1; i >= 0; --i) {
    const ChainLink& k = links_[i];
    const double c = of(cosine_of, i / width)[i % width];
    const double s = of(sine_of, i / width)[i % width];
    Factors& here = factors_[i];
    here.nx = -s;
    here.ny = c;
    here.Bxx = fma(c * c, B.uu, fma(-2.0 * c * s, B.un, s * s * B.nn));
    here.Byy = fma(s * s, B.uu, fma(2.0 * c * s, B.un, c * c * B.nn));
    here.Bxy = fma(c * s, B.uu - B.nn, (c * c - s * s) * B.un);
    here.fx = fma(fu, c, -(fn * s));
    here.fy = fma(fu, s, fn * c);
    const double D = fma(k.LL, B.nn, k.Io) + fma(2.0 * k.L, fn, kappa);
    const double wu = fma(k.L, B.un, fu);
    const double wn = fma(k.L, B.nn, k.mc) + fn;
    const bool is_held = effects_ && effects_->held[i];
    here.r = is_held ? 0.0 : 1.0 / (D + rotor_[i]);
    here.s = is_held ? 1.0 : rotor_[i] * here.r;
    here.wx = fma(wu, c, -(wn * s));
    here.wy = fma(wu, s, wn * c);
    if (i == 0) break;
    const double c_before = of(cosine_of, (i - 1) / width)[(i - 1) % width];
    const double s_before = of(sine_of, (i - 1) / width)[(i - 1) % width];
    const double cos = fma(c, c_before, s * s_before);
    const double sin = fma(s, c_before, -(c * s_before));
    const double cc = cos * cos;
    const double ss = sin * sin;
    const double sc = sin * cos;
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

template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::start_waves(double t) const {
  if (!effects_ || effects_->waves == 0) return;
  effects_->compute_waves(t, 0);
  for (int k = 0; k < effects_->waves; ++k) {
    wave_sine_[k] = effects_->wave_sine[k];
    wave_cosine_[k] = effects_->wave_cosine[k];
  }
}

/// Takes the waves sin(phase + omega sigma theta) from order k to the next.
template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::advance_waves(double sigma, int k) const {
  if (!effects_) return;
  for (int i = 0; i < effects_->waves; ++i) {
    const double factor = effects_->angular_frequency[i] * sigma * inverse_of[k + 1];
    const double sine = wave_sine_[i];
    wave_sine_[i] = factor * wave_cosine_[i];
    wave_cosine_[i] = -(factor * sine);
  }
}

template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::pivot_acceleration(double t, double sigma, int k, double& x,
                                                          double& y) const {
  x = 0.0;
  y = k == 0 ? -(sigma * sigma * gravity_) : 0.0;
  if (!effects_) return;
  for (const auto& law : effects_->pivots) {
    auto along = [&](const DrivenPivot::Law::Axis& axis) {
      const double of_piece = k == 0   ? fma(axis.slope, t - law->start, axis.held)
                              : k == 1 ? sigma * axis.slope
                                       : 0.0;
      return sigma * sigma * fma(axis.gain, wave_sine_[axis.wave], of_piece);
    };
    x += along(law->x);
    y += along(law->y);
  }
}

/// Adds the torques of the effects, order k, from angle_ and speed_ of that order.
template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::add_couples(double t, double sigma, int k) const {
  constexpr int margin = chain_series_detail::margin;
  if (!effects_ || (effects_->couples.empty() && effects_->joint_waves.empty())) return;
  double* const couple = couple_.data() + margin;
  std::fill_n(couple, row_, 0.0);
  for (const Couples<Row>& one : effects_->couples) {
    const int at = one.row * width;
    const Row phi = load<Row>(&angle_[margin + at]) - load<Row>(&angle_[margin + at - 1]);
    const Row w = load<Row>(&speed_[margin + at]) - load<Row>(&speed_[margin + at - 1]);
    const double square = sigma * sigma;
    Row torque = fma(square * one.on_phi, phi, sigma * one.on_phid * w);
    if (k == 0) torque = torque + square * one.template in_time<Row>(t);
    if (k == 1) torque = torque + square * sigma * one.slope;
    if (one.has_powers()) {
      double* const rates = of(relative_of, one.row);
      double* const squares = of(square_of, one.row);
      const auto rate = [rates](int j) __attribute__((always_inline)) {
        return load<Row>(rates + static_cast<std::ptrdiff_t>(j) * width);
      };
      const auto square_of_rate = [squares](int j) __attribute__((always_inline)) {
        return load<Row>(squares + static_cast<std::ptrdiff_t>(j) * width);
      };
      store(rates + static_cast<std::ptrdiff_t>(k) * width, w);
      const Row w2 = order_of_product(k, rate, rate);
      store(squares + static_cast<std::ptrdiff_t>(k) * width, w2);
      const Row w3 = order_of_product(k, square_of_rate, rate);
      torque = fma(one.on_phid2, w2, fma(one.on_phid3 / sigma, w3, torque));
    }
    store(couple + at, torque);
  }
  for (const JointWave& one : effects_->joint_waves) {
    couple[one.joint] += sigma * sigma * one.gain * wave_sine_[one.wave];
  }
  for (int i = 0; i < row_; i += width) {
    store(&torque_[i],
          Row(load<Row>(&torque_[i]) + (load<Row>(couple + i) - load<Row>(couple + i + 1))));
  }
}

/// Computes alpha and H of every link from the torques, beta, and the acceleration of the pivot.
template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::solve(double ax, double ay) const {
  double bx = 0.0;
  double by = 0.0;
  double t = 0.0;
  for (int i = n_ - 1; i >= 0; --i) {
    const ChainLink& k = links_[i];
    const Factors& here = factors_[i];
    const double x = beta_x_[i];
    const double y = beta_y_[i];
    const double px = fma(k.L, fma(here.Bxx, x, here.Bxy * y), bx);
    const double py = fma(k.L, fma(here.Bxy, x, here.Byy * y), by);
    const double of_beta = fma(k.L, fma(here.fx, x, here.fy * y), t);
    const double torque = torque_[i] - fma(k.L, fma(here.nx, px, here.ny * py), of_beta);
    const double free = here.r * torque;
    passing_[i] = {bx, by, t, free};
    bx = fma(here.wx, free, fma(k.mc, x, px));
    by = fma(here.wy, free, fma(k.mc, y, py));
    t = -(here.s * torque);
  }
  double before = 0.0;
  for (int i = 0; i < n_; ++i) {
    const ChainLink& k = links_[i];
    const Factors& here = factors_[i];
    const Passing& passing = passing_[i];
    const double alpha =
        fma(here.s, before, fma(-here.r, fma(here.wx, ax, here.wy * ay), passing.free));
    const double x = fma(k.L, fma(alpha, here.nx, beta_x_[i]), ax);
    const double y = fma(k.L, fma(alpha, here.ny, beta_y_[i]), ay);
    const double force_x = fma(here.fx, alpha, fma(here.Bxx, x, fma(here.Bxy, y, passing.bx)));
    const double force_y = fma(here.fy, alpha, fma(here.Bxy, x, fma(here.Byy, y, passing.by)));
    hx_[i] = fma(k.mc, ax, k.L * force_x);
    hy_[i] = fma(k.mc, ay, k.L * force_y);
    alpha_[i] = before = alpha;
    ax = x;
    ay = y;
  }
}

template <class Row>
PENDCORE_INLINE void ChainSeries<Row>::expand(double t, const double* y, double sigma, int order,
                                              double* coefficients) const {
  constexpr int margin = chain_series_detail::margin;
  const double per_sigma = 1.0 / sigma;  // exact: a power of two
  double* const angle = angle_.data() + margin;
  double* const speed = speed_.data() + margin;
  for (int g = 0; g < groups_; ++g) {
    const int at = g * width;
    Row s, c;
    sine_cosine(load<Row>(y + at), s, c);
    const Row w = sigma * load<Row>(y + row_ + at);
    store(of(cosine_of, g), c);
    store(of(sine_of, g), s);
    store(of(rate_of, g), w);
    store(of(cosine_of, g) + width, Row(-(w * s)));
    store(of(sine_of, g) + width, Row(w * c));
    store(angle + at, load<Row>(y + at));
    store(speed + at, w);
  }
  factor();
  start_waves(t);

  for (int k = 0; k < order; ++k) {
    const double next = k + 1.0;
    for (int g = 0; g < groups_; ++g) {
      const double* const c = of(cosine_of, g);
      const double* const s = of(sine_of, g);
      const double* const w = of(rate_of, g);
      const double* const hx = of(hx_of, g);
      const double* const hy = of(hy_of, g);
      Row along_x{}, along_y{}, by_x{}, by_y{};
      for (int j = 0; j < k; ++j) {
        const Row c_j = load<Row>(c + static_cast<std::ptrdiff_t>(k - j) * width);
        const Row s_j = load<Row>(s + static_cast<std::ptrdiff_t>(k - j) * width);
        const Row w_j = load<Row>(w + static_cast<std::ptrdiff_t>(j + 1) * width);
        along_x = fma(w_j, s_j, along_x);
        along_y = fma(w_j, c_j, along_y);
        by_x = fma(load<Row>(hx + static_cast<std::ptrdiff_t>(j) * width), s_j, by_x);
        by_y = fma(load<Row>(hy + static_cast<std::ptrdiff_t>(j) * width), c_j, by_y);
      }
      const Row w_0 = load<Row>(w);
      along_x = fma(w_0, load<Row>(s + static_cast<std::ptrdiff_t>(k + 1) * width), along_x);
      along_y = fma(w_0, load<Row>(c + static_cast<std::ptrdiff_t>(k + 1) * width), along_y);
      store(&beta_x_[g * width], Row(-next * along_x));
      store(&beta_y_[g * width], Row(next * along_y));
      store(&torque_[g * width], Row(by_x - by_y));
    }
    add_couples(t, sigma, k);
    double ax, ay;
    pivot_acceleration(t, sigma, k, ax, ay);
    advance_waves(sigma, k);
    solve(ax, ay);
    double* const row = coefficients + static_cast<std::ptrdiff_t>(k + 1) * 2 * row_;
    for (int g = 0; g < groups_; ++g) {
      const int at = g * width;
      double* const c = of(cosine_of, g);
      double* const s = of(sine_of, g);
      double* const w = of(rate_of, g);
      const Row alpha = load<Row>(&alpha_[at]);
      const Row q_next = inverse_of[k + 1] * load<Row>(w + static_cast<std::ptrdiff_t>(k) * width);
      const Row w_next = inverse_of[k + 1] * alpha;
      const double share = inverse_of[k + 1] * inverse_of[k + 2];
      const std::ptrdiff_t after = static_cast<std::ptrdiff_t>(k + 2) * width;
      store(c + after, Row(share * fma(-alpha, load<Row>(s), load<Row>(&beta_x_[at]))));
      store(s + after, Row(share * fma(alpha, load<Row>(c), load<Row>(&beta_y_[at]))));
      store(w + static_cast<std::ptrdiff_t>(k + 1) * width, w_next);
      store(of(hx_of, g) + static_cast<std::ptrdiff_t>(k) * width, load<Row>(&hx_[at]));
      store(of(hy_of, g) + static_cast<std::ptrdiff_t>(k) * width, load<Row>(&hy_[at]));
      store(row + at, q_next);
      store(row + row_ + at, Row(per_sigma * w_next));
      store(angle + at, q_next);
      store(speed + at, w_next);
    }
  }
}

}  // namespace pendcore
