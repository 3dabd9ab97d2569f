/// \file
/// How the series of double_pendulum_series.hpp change along eight names at once.
///
/// A change (dq, dqd) obeys linear equations, whose coefficients all names have in common. With N
/// the n of the other link along the axes of this one, u = (n_y, -n_x), and P = gamma (s_0, c_0) -
/// rho u''(other),
///
///     dqdd + (rho n.N - sigma) dqdd' = -rho (2 n.N_t dqd' + n.N_tt dq') - u.P dq
///                                      + dgamma cos q - drho n.u''(other) + dsigma qdd' + d(tau/A)
///
/// From their series c of n.N, h of 2 n.N_t, g of n.N_tt and w of u.P, with sums over m <= k and
/// j = k - m,
///
///     (k + 1) (k + 2) (dq_{k+2} + kappa dq'_{k+2}) = -rho sum_{m>=-1} e_m dq'_j
///                                                    - sum_{m>=0} w_m dq_j + f_k
///     e_m = j (j - 1) c_{m+2} + j h_{m+1} + g_m,   kappa = rho c_0 - sigma
///
/// Each e_m is a polynomial in k, with one c_{m+2} before k^2.
///
/// So an order of all eight changes of both links takes four fused operations for each order before
/// it. Slopes of the recurrence for n and qd itself took sixteen.
///
/// Cost: for order p, the series of the values; nine sums of products that the names share; and
/// 2 p^2 operations on packs for each eight names.
#pragma once

#include <array>
#include <utility>

#include "arithmetic/dual_rows.hpp"
#include "dynamics/mechanism.hpp"
#include "dynamics/series/double_pendulum_series.hpp"
#include "dynamics/series/effects_with_slopes.hpp"

namespace pendcore {

/// What the equations of changes have in common along a step: series in units of sigma.
class ChangesInCommon {
 public:
  using Orders = Pack<8>;          ///< eight orders of a series
  static constexpr int room = 48;  ///< for the orders, and a pack of zeros after them
  static_assert(highest_order + 2 + 8 <= room);
  using Series = std::array<double, room>;

  /// The series of a step's values, and what the equations make of them, up to an order.
  template <class OfLinks, class Torque>
  PENDCORE_INLINE void find(const OfLinks& constants, const double* y, double sigma, int order,
                            Torque& torque);

  Series angle[2], rate[2], acceleration[2];  ///< in powers of sigma
  Series cosine[2];                           ///< sigma^2 cos q
  Series bend[2];                             ///< n.u''(other)
  Series pull[2];                             ///< -w
  Pair kappa;
  /// -rho e_m = (square k + slope) k + constant, from m = -1 on.
  struct OfAngle {
    Series square, slope, constant;
  };
  OfAngle of_angle[2];

 private:
  /// A vector along the axes of a link, with zeros before order 0, which is at `room`.
  struct Vectors {
    double x[2 * room]{}, y[2 * room]{};
    PENDCORE_INLINE void set(int k, double x_k, double y_k) {
      x[room + k] = x_k;
      y[room + k] = y_k;
    }
    /// Ends the series before an order: what a longer one has left may be infinite.
    PENDCORE_INLINE void end(int order) {
      store(x + room + order, Orders{});
      store(y + room + order, Orders{});
    }
  };
  PENDCORE_INLINE static Orders eight_orders(const Vectors& a, const Vectors& b, int first);
  PENDCORE_INLINE static void multiply(const Vectors& a, const Vectors& b, int order, double factor,
                                       Series& product);

  double coefficients_[4 * (highest_order + 1)];
  Series c_, h_, g_;
  Vectors n_[2], u_[2], other_, once_, twice_, pull_;
};

/// Orders first .. first + 7 of a.b.
PENDCORE_INLINE ChangesInCommon::Orders ChangesInCommon::eight_orders(const Vectors& a,
                                                                      const Vectors& b, int first) {
  Orders x{}, y{};
  for (int j = 0; j < first + 8; ++j) {
    x = fma(a.x[room + j], load<Orders>(b.x + room + first - j), x);
    y = fma(a.y[room + j], load<Orders>(b.y + room + first - j), y);
  }
  return x + y;
}
/// Sets orders 0 .. order - 1 of `product` to those of a.b, times a factor.
PENDCORE_INLINE void ChangesInCommon::multiply(const Vectors& a, const Vectors& b, int order,
                                               double factor, Series& product) {
  for (int first = 0; first < order; first += 8) {
    store(product.data() + first, Orders(factor * eight_orders(a, b, first)));
  }
}

template <class OfLinks, class Torque>
PENDCORE_INLINE void ChangesInCommon::find(const OfLinks& constants, const double* y, double sigma,
                                           int order, Torque& torque) {
  DoublePendulumOrders<double>::Last last;
  DoublePendulumOrders<double> orders(constants, y, sigma, torque, coefficients_, last);
  complete(orders, order, torque, coefficients_, last);
  const Pair start = load<Pair>(y);
  Pair s0, c0;
  sine_cosine(start, s0, c0);
  for (int i = 0; i < 2; ++i) {
    Vectors& n = n_[i];
    n.set(0, 0.0, 1.0);
    n.set(1, orders.minus_rate[i], 0.0);
    for (int k = 2; k < order + 2; ++k) n.set(k, orders.n[k][i], orders.n[k][2 + i]);
    n.end(order + 2);
    for (int k = 0; k < order; ++k) u_[i].set(k, n.y[room + k], -n.x[room + k]);
    u_[i].end(order);
    angle[i][0] = start[i];
    for (int k = 0; k < order; ++k) {
      rate[i][k] = orders.rates[k][i];
      angle[i][k + 1] = inverse_of[k + 1] * orders.rates[k][i];
      acceleration[i][k] = (k + 1) * orders.rates[k + 1][i];
      cosine[i][k] = sigma * sigma * fma(s0[i], n.x[room + k], c0[i] * n.y[room + k]);
    }
  }
  const double sine_12 = fma(s0[1], c0[0], -(c0[1] * s0[0]));  // of q_2 - q_1
  const double cos = fma(c0[1], c0[0], s0[1] * s0[0]);
  for (int i = 0; i < 2; ++i) {
    const double sin = i == 0 ? sine_12 : -sine_12;
    const Vectors& n = n_[1 - i];
    for (int k = 0; k < order + 2; ++k) {
      const double along = n.x[room + k], across = n.y[room + k];
      other_.set(k, fma(cos, along, -(sin * across)), fma(sin, along, cos * across));
    }
    const double determinant = 1.0 / orders.inverse[i];
    for (int k = 0; k <= order; ++k) {
      const double by = 2.0 * (k + 1);
      once_.set(k, by * other_.x[room + k + 1], by * other_.y[room + k + 1]);
    }
    for (int k = 0; k < order; ++k) {
      const double by_both = (k + 1.0) * (k + 2.0);
      twice_.set(k, by_both * other_.x[room + k + 2], by_both * other_.y[room + k + 2]);
      pull_.set(k, determinant * orders.pulls[k][i], determinant * orders.pulls[k][2 + i]);
    }
    other_.end(order + 2);
    once_.end(order + 1);
    twice_.end(order);
    pull_.end(order);
    if (i == 0) multiply(n_[0], other_, order + 2, 1.0, c_);
    multiply(n_[i], once_, order + 1, 1.0, h_);
    multiply(n_[i], twice_, order, 1.0, g_);
    multiply(u_[i], pull_, order, -1.0, pull[i]);
    multiply(u_[i], twice_, order, -1.0, bend[i]);
    const double rho = constants.coupling[i];
    for (int m = -1; m < order; ++m) {
      const double of_rate = h_[m + 1];
      const double square = -rho * c_[m + 2];
      of_angle[i].square[m + 1] = square;
      of_angle[i].slope[m + 1] = -fma(2.0 * m + 1.0, square, rho * of_rate);
      of_angle[i].constant[m + 1] =
          fma(m * (m + 1.0), square, rho * (m * of_rate - (m == -1 ? 0.0 : g_[m])));
    }
  }
  kappa = constants.coupling * c_[0] - constants.rotor;
}

/// Two links that turn freely, whose pivot stands still and which at most two waves drive.
class DoublePendulumAlongNames {
  using Links = PairOf<AlongNames>;
  struct Constants {  ///< as ConstantsOfDoublePendulum, but a pair each
    Links weight, coupling, rotor, product, delta, epsilon;
  };

 public:
  using Effects = EffectsWithSlopes<Links>;

  static bool has(const Effects& effects) {
    return !effects.any_held && effects.pivots.empty() && effects.waves <= 2;
  }
  DoublePendulumAlongNames(const Mechanism<AlongNames>& of, Effects effects);

  void set_order(int /*order*/) {}
  /// Finds what all names have in common on a step from a state y.
  PENDCORE_INLINE void find_common(double t, const double* y, double sigma, int order,
                                   ChangesInCommon& common) const;
  /// Fills rows 1 .. order of `rows` with the changes, from those in row 0.
  PENDCORE_INLINE void expand(const ChangesInCommon& common, double t, double sigma, int order,
                              AlongNames* rows) const;

 private:
  Constants constants_;
  Links factor_;  ///< 1/A
  Effects effects_;
};

PENDCORE_INLINE void DoublePendulumAlongNames::find_common(double t, const double* y, double sigma,
                                                           int order,
                                                           ChangesInCommon& common) const {
  const ConstantsOfDoublePendulum<double> constants{.weight = constants_.weight.value,
                                                    .coupling = constants_.coupling.value,
                                                    .rotor = constants_.rotor.value,
                                                    .product = constants_.product.value[0],
                                                    .delta = constants_.delta.value[0],
                                                    .epsilon = constants_.epsilon.value[0]};
  if (effects_.couples.empty() && effects_.waves == 0) {
    NoTorque none;
    return common.find(constants, y, sigma, order, none);
  }
  const TorqueLaws<Links, AlongNames> laws = torque_laws(effects_, factor_);
  Couples<Pair> couples;
  if (laws.couples != nullptr) {
    each_field(couples, *laws.couples, [](Pair& to, const Links& from) { to = from.value; });
    couples.has_powers = laws.couples->has_powers;
  }
  const TorqueLaws<Pair, double> values{.couples = laws.couples != nullptr ? &couples : nullptr,
                                        .waves = laws.waves,
                                        .angular_frequency = laws.angular_frequency.value,
                                        .phase = laws.phase.value,
                                        .gain = {laws.gain[0].value, laws.gain[1].value},
                                        .factor = laws.factor.value};
  TorqueOrders<Pair, double> torque(values, t, sigma);
  common.find(constants, y, sigma, order, torque);
}

PENDCORE_INLINE void DoublePendulumAlongNames::expand(const ChangesInCommon& common, double t,
                                                      double sigma, int order,
                                                      AlongNames* rows) const {
  using Slopes = decltype(AlongNames::slope);
  using Orders = ChangesInCommon::Orders;
  const TorqueLaws<Links, AlongNames> laws = torque_laws(effects_, factor_);
  TorqueOrders<Links, AlongNames, Links> torque(laws, t, sigma);
  const auto both = [](const Links& x) { return std::array{x.slope.first, x.slope.second}; };
  const std::array dgamma = both(constants_.weight), drho = both(constants_.coupling),
                   dsigma = both(constants_.rotor);
  const Pair& kappa = common.kappa;
  const double determinant = 1.0 / fma(-kappa[0], kappa[1], 1.0);

  Slopes changes[highest_order + 3][2];  // of the angles
  double e[2][ChangesInCommon::room];    // from m = -1 on
  for (int i = 0; i < 2; ++i) {
    changes[0][i] = rows[i].slope;
    changes[1][i] = sigma * rows[2 + i].slope;
  }
  const double per_sigma = inverse_of_power_of_two(sigma);
  for (int k = 0; k < order; ++k) {
    for (int i = 0; i < 2; ++i) {
      const auto& [square, slope, constant] = common.of_angle[i];
      for (int m = 0; m < k + 2; m += Lanes<Orders>::width) {
        const Orders by_k = fma(static_cast<double>(k), load<Orders>(square.data() + m),
                                load<Orders>(slope.data() + m));
        store(e[i] + m, fma(static_cast<double>(k), by_k, load<Orders>(constant.data() + m)));
      }
    }
    std::array<Slopes, 2> known, more{};
    for (int i = 0; i < 2; ++i) {
      known[i] = fma(common.cosine[i][k], dgamma[i],
                     fma(-common.bend[i][k], drho[i], common.acceleration[1 - i][k] * dsigma[i]));
    }
    if (torque.are_any()) {
      const auto links = [&](const auto& series, int order_of_change,
                             double by) __attribute__((always_inline)) {
        return Links{Pair{series[0][k], series[1][k]},
                     {by * changes[order_of_change][0], by * changes[order_of_change][1]}};
      };
      const Links given =
          torque.next(k, links(common.angle, k, 1.0), links(common.rate, k + 1, k + 1.0));
      known[0] = known[0] + given.slope.first;
      known[1] = known[1] + given.slope.second;
    }
    for (int j = 0; j <= k; ++j) {
      known[0] = fma(e[0][k - j + 1], changes[j][1], known[0]);
      known[1] = fma(e[1][k - j + 1], changes[j][0], known[1]);
      more[0] = fma(common.pull[0][k - j], changes[j][0], more[0]);
      more[1] = fma(common.pull[1][k - j], changes[j][1], more[1]);
    }
    const Slopes first = fma(e[0][0], changes[k + 1][1], known[0] + more[0]);
    const Slopes second = fma(e[1][0], changes[k + 1][0], known[1] + more[1]);
    const double share = inverse_of[k + 1] * inverse_of[k + 2] * determinant;
    changes[k + 2][0] = share * fma(-kappa[0], second, first);
    changes[k + 2][1] = share * fma(-kappa[1], first, second);
    for (int i = 0; i < 2; ++i) {
      rows[4 * (k + 1) + i].slope = changes[k + 1][i];
      rows[4 * (k + 1) + 2 + i].slope = ((k + 2) * per_sigma) * changes[k + 2][i];
    }
  }
}

/// The constants are those of the closed forms (double_pendulum_with_effects.cpp).
inline DoublePendulumAlongNames::DoublePendulumAlongNames(const Mechanism<AlongNames>& of,
                                                          Effects effects)
    : effects_(std::move(effects)) {
  using Number = AlongNames;
  const auto& first = of.bodies[0];
  const auto& second = of.bodies[1];
  const Number J = second.armature;
  const Number hung = second.mass + of.payload_mass;
  const Number square = first.length * first.length;
  const Number about_joint =
      first.inertia + first.mass * first.center * first.center + first.armature;
  const Number about_center = second.inertia + of.payload_inertia;
  const Number A1 = about_joint + square * hung;  // without J
  const Number A2 = about_center + second.mass * second.center * second.center +
                    of.payload_mass * second.length * second.length;
  const Number apart = second.length - second.center;
  const Number determinant =
      about_joint * A2 +
      square * (hung * about_center + second.mass * of.payload_mass * apart * apart);
  const Number a1 = first.mass * first.center + first.length * hung;
  const Number a2 = second.mass * second.center + second.length * of.payload_mass;
  const Number A12 = first.length * a2;
  factor_ = pair_of(1.0 / (A1 + J), 1.0 / (A2 + J));
  const Links both = factor_ * other(factor_);
  const auto links = [](const Number& x) { return pair_of(x, x); };
  constants_ = {.weight = links(of.gravity) * (pair_of(a1, a2) * factor_),
                .coupling = links(A12) * factor_,
                .rotor = links(J) * factor_,
                .product = links(A12 * A12) * both,
                .delta = links(determinant + J * (A1 + A2)) * both,
                .epsilon = links(2.0 * (A12 * J)) * both};
}

}  // namespace pendcore
