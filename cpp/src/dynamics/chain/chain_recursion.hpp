/// \file
/// The recursion of chain.hpp.
#pragma once

#include <algorithm>

#include "dynamics/chain/chain.hpp"
#include "dynamics/row.hpp"

namespace pendcore {

/// Copies n links, plain ones in whole packs.
PENDCORE_INLINE void copy_links(const double* from, int n, double* to) {
  int i = 0;
  for (; i + 4 <= n; i += 4) store(to + i, load<Pack<4>>(from + i));
  if (i == n) return;
  Pack<4> rest{from[i], 0.0, 0.0, 0.0};
  if (i + 1 < n) rest[1] = from[i + 1];
  if (i + 2 < n) rest[2] = from[i + 2];
  store(to + i, rest);
}
template <class Along>
PENDCORE_INLINE void copy_links(const Dual<double, Along>* from, int n, Dual<double, Along>* to) {
  std::copy_n(from, n, to);
}

/// Computes sines and cosines of four links.
template <class Row, class Number>
PENDCORE_INLINE void sines_cosines(const Number* q, Number* s, Number* c) {
  if constexpr (Lanes<Row>::width == 4) {
    Row sine, cosine;
    sine_cosine(load<Row>(q), sine, cosine);
    store(s, sine);
    store(c, cosine);
  } else {
    Pack<4> sine, cosine;
    sine_cosine(Pack<4>{q[0].value, q[1].value, q[2].value, q[3].value}, sine, cosine);
    for (int i = 0; i < 4; ++i) {
      s[i] = {sine[i], cosine[i] * q[i].slope};
      c[i] = {cosine[i], -(sine[i] * q[i].slope)};
    }
  }
}

template <class Number>
PENDCORE_INLINE void ChainOf<Number>::prepare(const Number* q, const Number* qd) const {
  Number* const s = in(s_);
  Number* const c = in(c_);
  copy_links(q, n_, in(q_));
  copy_links(qd, n_, in(qd_));
  for (int i = 0; i < padded_; i += 4) sines_cosines<Row>(in(q_) + i, s + i, c + i);
  for (int i = 0; i < padded_; i += width) {
    const Row rate = load<Row>(in(qd_) + i);
    const Row square = rate * rate;
    store(in(centripetal_) + i, Row(load<Row>(in(length_) + i) * square));
    store(in(center_) + i, Row(load<Row>(in(mass_moment_) + i) * square));
    const Row sine = load<Row>(s + i);
    const Row cosine = load<Row>(c + i);
    const Row sine_before = before(sine, load<Row>(s + i - width));
    const Row cosine_before = before(cosine, load<Row>(c + i - width));
    const Row cos = fma(cosine, cosine_before, sine * sine_before);
    const Row sin = fma(sine, cosine_before, -(cosine * sine_before));
    store(in(cos_) + i, cos);
    store(in(sin_) + i, sin);
    store(in(cc_) + i, Row(cos * cos));
    store(in(ss_) + i, Row(sin * sin));
    store(in(sc_) + i, Row(sin * cos));
  }
}

/// The loads that a law adds on a row of four links.
template <class Row>
struct ChainLoads {
  using Number = typename Lanes<Row>::Number;
  Number *couples, *moments, *fx, *fy;
  PENDCORE_INLINE static void add(Number* to, const Row& x) { store(to, Row(load<Row>(to) + x)); }
  PENDCORE_INLINE void couple(const Row& tau) { add(couples, tau); }
  PENDCORE_INLINE void generalised(const Row& Q) { add(moments, Q); }
  PENDCORE_INLINE void force(const Row& moment, const Row& x, const Row& y) {
    add(moments, moment);
    add(fx, x);
    add(fy, y);
  }
};

/// Calls use(law, row) with a law of four links and its row, or with that of each link alone.
template <class Number>
template <template <class> class Law, class Use>
PENDCORE_INLINE void ChainOf<Number>::in_rows(const Law<Pack<4>>& all, int row,
                                              const Use& use) const {
  if constexpr (width == 1) {
    for (int i = 4 * row; i < std::min(4 * row + 4, n_); ++i) use(law_of_lane(all, i % 4), i);
  } else {
    use(all, row);
  }
}

/// Collects the torque on each link, and the force on it in its own frame.
template <class Number>
PENDCORE_INLINE void ChainOf<Number>::collect_loads(double t) const {
  using Effects = EffectsInRows<Pack<4>>;
  const Effects& effects = *effects_;
  const bool forces = effects.has_forces;
  Number* const couple = in(couple_);
  Number* const torque = in(torque_);
  Number* const fx = in(fx_);
  Number* const fy = in(fy_);
  for (int i = 0; i < padded_; i += width) {
    store(couple + i, Row{});
    store(torque + i, Row{});
    store(fx + i, Row{});
    store(fy + i, Row{});
  }
  if (forces) {
    double pivot_x = 0.0;
    double pivot_y = 0.0;
    if (!effects.pivots.empty()) effects.pivot_velocity(t, pivot_x, pivot_y);
    Number x = pivot_x;
    Number y = pivot_y;
    for (int i = 0; i < n_; ++i) {
      in(vx_)[i] = x;
      in(vy_)[i] = y;
      const Number speed = in(length_)[i] * in(qd_)[i];
      x = fma(-speed, in(s_)[i], x);
      y = fma(speed, in(c_)[i], y);
    }
  }
  const ArraysOver<Number> links{in(q_), in(qd_), in(s_), in(c_), in(length_), in(vx_), in(vy_)};
  auto loads_of = [&](int row) {
    const int i = width * row;
    return ChainLoads<Row>{couple + i, torque + i, fx + i, fy + i};
  };
  for (const Couples<Pack<4>>& all : effects.couples) {
    in_rows(all, all.row, [&](const auto& one, int row) __attribute__((always_inline)) {
      loads_of(row).couple(one.torque(RowInArrays<Row>(links, t, row)));
    });
  }
  for (const JointWave& one : effects.joint_waves) {
    couple[one.joint] += one.gain * effects.wave_sine[one.wave];
  }
  for (const auto& entry : effects.entries) {
    Effects::visit(entry, [&](const auto& all) __attribute__((always_inline)) {
      in_rows(all, entry.row, [&](const auto& one, int row) __attribute__((always_inline)) {
        ChainLoads<Row> loads = loads_of(row);
        one.add(RowInArrays<Row>(links, t, row), loads);
      });
    });
  }
  if constexpr (width > 1) {
    for (const UserLaw& user : effects.users) {
      Number* const Q = in(user_);
      for (int i = 0; i < n_; ++i) Q[i] = Number{};
      effects.call(user, t, in(q_), in(qd_), Q);
      for (int i = 0; i < n_; ++i) torque[i] += Q[i];
    }
  }
  for (int i = 0; i < padded_; i += width) {
    const Row couples = load<Row>(couple + i);
    store(torque + i,
          Row(load<Row>(torque + i) + couples - after(couples, load<Row>(couple + i + width))));
    if (forces) {
      const Row x = load<Row>(fx + i);
      const Row y = load<Row>(fy + i);
      const Row s = load<Row>(in(s_) + i);
      const Row c = load<Row>(in(c_) + i);
      store(fx + i, fma(c, x, s * y));
      store(fy + i, fma(c, y, -(s * x)));
    }
  }
}

template <class Number>
PENDCORE_INLINE LinkInMotion<Number> ChainOf<Number>::in_motion(int i) const {
  return {.s = in(s_)[i],
          .c = in(c_)[i],
          .cos = in(cos_)[i],
          .sin = in(sin_)[i],
          .cc = in(cc_)[i],
          .ss = in(ss_)[i],
          .sc = in(sc_)[i],
          .centripetal = in(centripetal_)[i],
          .center = in(center_)[i],
          .torque = in(torque_)[i],
          .force_u = in(fx_)[i],
          .force_n = in(fy_)[i]};
}

template <class Number>
template <bool loaded, int size>
PENDCORE_INLINE void ChainOf<Number>::tip_to_base() const {
  const int n = size > 0 ? size : n_;
  JointForce<Number> force{{payload_mass_, 0.0, payload_mass_}, 0.0, 0.0};
#pragma GCC unroll 3
  for (int i = n - 1; i >= 0; --i) {
    const FreeResponse<Number> found = force.template add_free<loaded>(links_[i], in_motion(i));
    response_[i] = {found.free, found.x, found.y, 0.0};
  }
}

template <class Number>
PENDCORE_INLINE void ChainOf<Number>::tip_to_base_coupled() const {
  CoupledForce<Number> force{.B = {payload_mass_, 0.0, payload_mass_}};
  for (int i = n_ - 1; i >= 0; --i) {
    response_[i] = force.add(links_[i], rotor_[i], effects_->held[i] != 0, in_motion(i));
  }
}

template <class Number>
template <bool coupled, int size>
PENDCORE_INLINE void ChainOf<Number>::base_to_tip(const Number& ax, const Number& ay,
                                                  Number* qdd) const {
  const int n = size > 0 ? size : n_;
  JointAcceleration<Number> of_joint{ax, ay};
  Number before = 0.0;
#pragma GCC unroll 3
  for (int i = 0; i < n; ++i) {
    const CoupledResponse<Number>& k = response_[i];
    const Number free = coupled ? fma(k.from_before, before, k.free) : k.free;
    before = go_to_next_joint(FreeResponse<Number>{free, k.x, k.y}, in(s_)[i], in(c_)[i],
                              Number(in(length_)[i]), in(centripetal_)[i], of_joint);
    qdd[i] = before;
  }
}

template <class Number>
PENDCORE_INLINE void ChainOf<Number>::accelerations(double t, const Number* q, const Number* qd,
                                                    Number* qdd) const {
  double ax = 0.0;
  double ay = 0.0;
  prepare(q, qd);
  if (loaded_) {
    effects_->compute_waves(t, 0);
    if (!effects_->pivots.empty()) effects_->pivot_acceleration(t, ax, ay);
    collect_loads(t);
  }
  ay -= gravity_;
  if (has_rotors_ || effects_->any_held) {
    tip_to_base_coupled();
    base_to_tip<true, 0>(ax, ay, qdd);
    return;
  }
  if (n_ == 3) {
    recursion<3>(ax, ay, qdd);
  } else {
    recursion<0>(ax, ay, qdd);
  }
}

template <class Number>
template <int size>
PENDCORE_INLINE void ChainOf<Number>::recursion(const Number& ax, const Number& ay,
                                                Number* qdd) const {
  if (loaded_) {
    tip_to_base<true, size>();
  } else {
    tip_to_base<false, size>();
  }
  base_to_tip<false, size>(ax, ay, qdd);
}

}  // namespace pendcore
