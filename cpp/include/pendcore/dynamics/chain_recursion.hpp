/// \file
/// The recursion of chain.hpp.
#pragma once

#include "pendcore/dynamics/chain.hpp"
#include "pendcore/dynamics/row.hpp"

namespace pendcore {

PENDCORE_INLINE void Chain::prepare(const double* q, const double* qd) const {
  double* const s = in(s_);
  double* const c = in(c_);
  __builtin_memcpy(in(q_), q, n_ * sizeof(double));
  __builtin_memcpy(in(qd_), qd, n_ * sizeof(double));
  for (int i = 0; i < padded_; i += 4) {
    const Row rate = load<Row>(in(qd_) + i);
    Row sine, cosine;
    sine_cosine(load<Row>(in(q_) + i), sine, cosine);
    store(s + i, sine);
    store(c + i, cosine);
    const Row square = rate * rate;
    store(in(centripetal_) + i, Row(load<Row>(in(length_) + i) * square));
    store(in(center_) + i, Row(load<Row>(in(mass_moment_) + i) * square));
  }
  for (int i = 0; i < padded_; i += 4) {
    const Row sine = load<Row>(s + i);
    const Row cosine = load<Row>(c + i);
    const Row sine_before = load<Row>(s + i - 1);
    const Row cosine_before = load<Row>(c + i - 1);
    const Row cos = fma(cosine, cosine_before, sine * sine_before);
    const Row sin = fma(sine, cosine_before, -(cosine * sine_before));
    store(in(cos_) + i, cos);
    store(in(sin_) + i, sin);
    store(in(cc_) + i, Row(cos * cos));
    store(in(ss_) + i, Row(sin * sin));
    store(in(sc_) + i, Row(sin * cos));
  }
}

/// What a law of four links adds to.
struct ChainLoads {
  double *couples, *moments, *fx, *fy;
  PENDCORE_INLINE static void add(double* to, const Pack<4>& x) {
    store(to, Pack<4>(load<Pack<4>>(to) + x));
  }
  PENDCORE_INLINE void couple(const Pack<4>& tau) { add(couples, tau); }
  PENDCORE_INLINE void generalised(const Pack<4>& Q) { add(moments, Q); }
  PENDCORE_INLINE void force(const Pack<4>& moment, const Pack<4>& x, const Pack<4>& y) {
    add(moments, moment);
    add(fx, x);
    add(fy, y);
  }
};

/// The torque on each link and, turned into its frame, the force.
PENDCORE_INLINE void Chain::collect_loads(double t) const {
  const ActingEffects<Row>& effects = *effects_;
  const bool forces = effects.has_forces;
  double* const couple = in(couple_);
  double* const torque = in(torque_);
  double* const fx = in(fx_);
  double* const fy = in(fy_);
  for (int i = 0; i < padded_; i += 4) {
    store(couple + i, Row{});
    store(torque + i, Row{});
    store(fx + i, Row{});
    store(fy + i, Row{});
  }
  if (forces) {
    double x = 0.0;
    double y = 0.0;
    if (!effects.pivots.empty()) effects.pivot_velocity(t, x, y);
    for (int i = 0; i < n_; ++i) {
      in(vx_)[i] = x;
      in(vy_)[i] = y;
      const double speed = in(length_)[i] * in(qd_)[i];
      x = fma(-speed, in(s_)[i], x);
      y = fma(speed, in(c_)[i], y);
    }
  }
  const LinkArrays links{in(q_), in(qd_), in(s_), in(c_), in(length_), in(vx_), in(vy_)};
  auto loads_of = [&](int row) {
    return ChainLoads{couple + 4 * row, torque + 4 * row, fx + 4 * row, fy + 4 * row};
  };
  for (const Couples<Row>& one : effects.couples) {
    loads_of(one.row).couple(one.torque(RowInArrays<Row>(links, t, one.row)));
  }
  for (const JointWave& one : effects.joint_waves) {
    couple[one.joint] += one.gain * effects.wave_sine[one.wave];
  }
  for (const auto& entry : effects.entries) {
    ChainLoads loads = loads_of(entry.row);
    ActingEffects<Row>::add(entry, RowInArrays<Row>(links, t, entry.row), loads);
  }
  for (const CompiledUser& user : effects.users) {
    double* const Q = in(user_);
    for (int i = 0; i < n_; ++i) Q[i] = 0.0;
    user(t, n_, in(q_), in(qd_), Q);
    for (int i = 0; i < n_; ++i) torque[i] += Q[i];
  }
  for (int i = 0; i < padded_; i += 4) {
    store(torque + i,
          Row(load<Row>(torque + i) + load<Row>(couple + i) - load<Row>(couple + i + 1)));
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

template <bool loaded, int size>
PENDCORE_INLINE void Chain::tip_to_base() const {
  const int n = size > 0 ? size : n_;
  double Buu = payload_mass_;
  double Bun = 0.0;
  double Bnn = payload_mass_;
  double b_u = 0.0;
  double b_n = 0.0;
#pragma GCC unroll 3
  for (int i = n - 1; i >= 0; --i) {
    const Constants& k = links_[i];
    const double D = fma(k.LL, Bnn, k.Io);
    const double r = 1.0 / D;
    const double speed = in(centripetal_)[i];
    const double pu = fma(-speed, Buu, b_u);
    const double pn = fma(-speed, Bun, b_n);
    const double torque = loaded ? fma(-k.L, pn, in(torque_)[i]) : -k.L * pn;
    const double free = torque * r;
    const double wu = k.L * Bun;
    const double wn = fma(k.L, Bnn, k.mc);
    double fu = pu - in(center_)[i];
    double fn = pn;
    if constexpr (loaded) {
      fu -= in(fx_)[i];
      fn -= in(fy_)[i];
    }
    fu = fma(wu, free, fu);
    fn = fma(wn, free, fn);
    const double s = in(s_)[i];
    const double c = in(c_)[i];
    response_[i] = {free, r * fma(wu, c, -(wn * s)), r * fma(wu, s, wn * c), 0.0};

    // Into the frame of the link before. What waits for the division comes in last.
    const double mass = k.m + Buu;
    const double uu = wu * wu;
    const double un = Bun * k.turn;
    const double nn = fma(Bnn, k.across, k.m * k.I);
    const double cc = in(cc_)[i];
    const double ss = in(ss_)[i];
    const double sc = in(sc_)[i];
    const double both = sc + sc;
    Bnn = fma(r, fma(-ss, uu, fma(both, un, cc * nn)), ss * mass);
    Bun = fma(r, fma(-sc, uu + nn, (cc - ss) * un), sc * mass);
    Buu = fma(r, fma(-cc, uu, fma(-both, un, ss * nn)), cc * mass);
    b_u = fma(fu, in(cos_)[i], -(fn * in(sin_)[i]));
    b_n = fma(fu, in(sin_)[i], fn * in(cos_)[i]);
  }
}

template <int size>
PENDCORE_INLINE void Chain::base_to_tip(double ax, double ay, double* qdd) const {
  const int n = size > 0 ? size : n_;
#pragma GCC unroll 3
  for (int i = 0; i < n; ++i) {
    const Response& k = response_[i];
    const double s = in(s_)[i];
    const double c = in(c_)[i];
    const double L = in(length_)[i];
    const double speed = in(centripetal_)[i];
    const double x = fma(-speed, c, ax);
    const double y = fma(-speed, s, ay);
    const double found = fma(-k.y, ay, fma(-k.x, ax, k.free));
    qdd[i] = found;
    ax = fma(-(L * s), found, x);
    ay = fma(L * c, found, y);
  }
}

PENDCORE_INLINE void Chain::tip_to_base_coupled() const {
  double Buu = payload_mass_;
  double Bun = 0.0;
  double Bnn = payload_mass_;
  double b_u = 0.0;
  double b_n = 0.0;
  double beta_u = 0.0;  // force per angular acceleration of the link before
  double beta_n = 0.0;
  double kappa = 0.0;  // torque per angular acceleration
  double t = 0.0;      // the rest of the torque
  for (int i = n_ - 1; i >= 0; --i) {
    const Constants& k = links_[i];
    const double speed = in(centripetal_)[i];
    const double pu = fma(-speed, Buu, b_u);
    const double pn = fma(-speed, Bun, b_n);
    const double D = fma(k.LL, Bnn, k.Io) + fma(2.0 * k.L, beta_n, kappa);
    const double J = rotor_[i];
    const bool is_held = effects_->held[i];
    const double r = is_held ? 0.0 : 1.0 / (D + J);
    const double share = is_held ? 1.0 : J * r;
    const double wu = fma(k.L, Bun, beta_u);
    const double wn = fma(k.L, Bnn, k.mc) + beta_n;
    const double torque = in(torque_)[i] - fma(k.L, pn, fma(-speed, beta_u, t));
    const double free = r * torque;
    const double fu = fma(wu, free, pu - in(center_)[i] - in(fx_)[i]);
    const double fn = fma(wn, free, pn - in(fy_)[i]);
    const double s = in(s_)[i];
    const double c = in(c_)[i];
    response_[i] = {free, r * fma(wu, c, -(wn * s)), r * fma(wu, s, wn * c), share};

    const double uu = fma(-r * wu, wu, k.m + Buu);
    const double un = fma(-r * wu, wn, Bun);
    const double nn = fma(-r * wn, wn, k.m + Bnn);
    const double cc = in(cc_)[i];
    const double ss = in(ss_)[i];
    const double sc = in(sc_)[i];
    const double cos = in(cos_)[i];
    const double sin = in(sin_)[i];
    Bnn = fma(ss, uu, fma(2.0 * sc, un, cc * nn));
    Bun = fma(sc, uu - nn, (cc - ss) * un);
    Buu = fma(cc, uu, fma(-2.0 * sc, un, ss * nn));
    b_u = fma(fu, cos, -(fn * sin));
    b_n = fma(fu, sin, fn * cos);
    beta_u = share * fma(wu, cos, -(wn * sin));
    beta_n = share * fma(wu, sin, wn * cos);
    kappa = share * D;
    t = -share * torque;
  }
}

PENDCORE_INLINE void Chain::base_to_tip_coupled(double ax, double ay, double* qdd) const {
  double before = 0.0;
  for (int i = 0; i < n_; ++i) {
    const Response& k = response_[i];
    const double s = in(s_)[i];
    const double c = in(c_)[i];
    const double L = in(length_)[i];
    const double speed = in(centripetal_)[i];
    const double found = fma(-k.y, ay, fma(-k.x, ax, fma(k.from_before, before, k.free)));
    qdd[i] = before = found;
    ax = fma(-(L * s), found, fma(-speed, c, ax));
    ay = fma(L * c, found, fma(-speed, s, ay));
  }
}

PENDCORE_INLINE void Chain::accelerations(double t, const double* q, const double* qd,
                                          double* qdd) const {
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
    base_to_tip_coupled(ax, ay, qdd);
    return;
  }
  if (n_ == 3) {
    recursion<3>(ax, ay, qdd);
  } else {
    recursion<0>(ax, ay, qdd);
  }
}

template <int size>
PENDCORE_INLINE void Chain::recursion(double ax, double ay, double* qdd) const {
  if (loaded_) {
    tip_to_base<true, size>();
  } else {
    tip_to_base<false, size>();
  }
  base_to_tip<size>(ax, ay, qdd);
}

}  // namespace pendcore
