/// \file
/// The equations that the changes of a double pendulum along all names have in common, with the
/// names and the units of time of double_pendulum_series.hpp.
///
/// A change (dq, dqd) obeys linear equations. With N the n of the other link along the axes of this
/// one, u = (n_y, -n_x), P = gamma (s_0, c_0) - rho u_tt(other), and j = J_2/A of the rotor,
///
///     dqdd + (rho n.N - j) dqdd' = -rho (2 n.N_t dqd' + n.N_tt dq') - u.P dq
///                                  + dgamma cos q - drho n.u_tt(other) + dj qdd' + d(tau/A)
///                                  + (a/A) dx_tt sin q
///
/// with x_tt the acceleration of the pivot along x. That along y takes from gravity.
///
/// From their series c of n.N, h of 2 n.N_t, g of n.N_tt and w of u.P, with sums over m <= k and
/// i = k - m,
///
///     (k + 1) (k + 2) (dq_{k+2} + kappa dq'_{k+2}) = -rho sum_{m>=-1} e_m dq'_i
///                                                    - sum_{m>=0} w_m dq_i + f_k
///     e_m = i (i - 1) c_{m+2} + i h_{m+1} + g_m,   kappa = rho c_0 - j
///
/// Each e_m is a polynomial in k, with one c_{m+2} before k^2.
///
/// With C and S the cosine and sine of q' - q, C_t = (qd - qd') S and S_t = (qd' - qd) C, so that
///
///     n.N = C,  2 n.N_t = -2 qd' S,  n.N_tt = -(qd' S)_t - qd qd' C
///     n.u_tt(other) = (qd' C)_t - qd qd' S,   u.P = gamma sin q - rho n.N_tt
///
/// Cost: for order p, the series of the values, and eight sums of products.
#pragma once

#include <array>

#include "dynamics/series/double_pendulum_series.hpp"

namespace pendcore {

/// Computes the series of these coefficients.
class CoefficientsOfChanges {
 public:
  using Orders = Pack<8>;  ///< eight orders of a series
  static constexpr int width = Lanes<Orders>::width;
  static constexpr int room = (highest_order + 2 + 2 * width - 1) / width * width;
  using Series = std::array<double, room>;
  /// A series with zeros before it.
  class PaddedSeries {
   public:
    double operator[](int k) const { return all_[room + k]; }
    double& operator[](int k) { return all_[room + k]; }
    PENDCORE_INLINE Orders eight(int first) const { return load<Orders>(all_ + room + first); }
    PENDCORE_INLINE void set_eight(int first, const Orders& x) { store(all_ + room + first, x); }

   private:
    double all_[2 * room]{};
  };

  /// Computes them from a state y, up to an order.
  template <class OfLinks, class Torque>
  PENDCORE_INLINE void find(const OfLinks& constants, const double* y, double sigma, int order,
                            Torque& torque);

  double states[4 * (highest_order + 1)];  ///< (q_1, q_2, qd_1, qd_2) of each order
  PaddedSeries rate[2];
  Series angle[2], acceleration[2];
  Series cosine[2], sine[2];  ///< sigma^2 cos q and sigma^2 sin q
  Series bend[2];             ///< n.u_tt(other)
  Series pull[2];             ///< -w
  Pair kappa;
  double inverse;  ///< 1/(1 - kappa kappa')
  /// -rho e_m = (square k + slope) k + constant, from m = -1 on.
  struct OfAngle {
    Series square, slope, constant;
  };
  OfAngle of_angle[2];

 private:
  static constexpr Series numbers = [] {
    Series all{};
    for (int k = 0; k < room; ++k) all[k] = k;
    return all;
  }();
  static constexpr Series inverses = [] {
    Series all{};
    for (int k = 1; k < room; ++k) all[k] = 1.0 / k;
    return all;
  }();
  PENDCORE_INLINE static Orders from(int first) { return load<Orders>(numbers.data() + first); }
  PENDCORE_INLINE static Orders one_over(int first) {
    return load<Orders>(inverses.data() + first);
  }
  PENDCORE_INLINE static Orders of_derivative(const PaddedSeries& x, int first) {
    return from(first + 1) * x.eight(first + 1);
  }
  PENDCORE_INLINE static Orders product(const PaddedSeries& a, const PaddedSeries& b, int first);
  PENDCORE_INLINE void find_products(double cos, double sin, int order);

  PaddedSeries along_[2], across_[2];        ///< n of each link, along its axes at the start
  PaddedSeries other_along_, other_across_;  ///< of the second one, along those of the first
  PaddedSeries cos_, sin_;                   ///< C and S of the first link
  PaddedSeries rate_by_cos_[2], rate_by_sin_[2];
  PaddedSeries second_[2];  ///< n.N_tt
};

/// Orders first .. first + 7 of a product. Factor a is zero beyond the orders that are asked for.
PENDCORE_INLINE CoefficientsOfChanges::Orders CoefficientsOfChanges::product(const PaddedSeries& a,
                                                                             const PaddedSeries& b,
                                                                             int first) {
  Orders even{}, odd{};
  for (int j = 0; j < first + width; j += 2) {
    even = fma(a[j], b.eight(first - j), even);
    odd = fma(a[j + 1], b.eight(first - j - 1), odd);
  }
  return even + odd;
}

/// Computes C, S, and their products with the rates.
PENDCORE_INLINE void CoefficientsOfChanges::find_products(double cos, double sin, int order) {
  for (int first = 0; first < order + 2; first += width) {
    const Orders x = along_[1].eight(first);
    const Orders y = across_[1].eight(first);
    other_along_.set_eight(first, fma(cos, x, -(sin * y)));
    other_across_.set_eight(first, fma(sin, x, cos * y));
  }
  for (int first = 0; first < order + 2; first += width) {
    cos_.set_eight(
        first, product(along_[0], other_along_, first) + product(across_[0], other_across_, first));
  }
  sin_[0] = sin;
  for (int first = 0; first <= order; first += width) {
    for (int i = 0; i < 2; ++i) rate_by_cos_[i].set_eight(first, product(rate[i], cos_, first));
    const Orders slope = rate_by_cos_[1].eight(first) - rate_by_cos_[0].eight(first);
    sin_.set_eight(first + 1, one_over(first + 1) * slope);
  }
  for (int first = 0; first <= order; first += width) {
    for (int i = 0; i < 2; ++i) rate_by_sin_[i].set_eight(first, product(rate[i], sin_, first));
  }
}

template <class OfLinks, class Torque>
PENDCORE_INLINE void CoefficientsOfChanges::find(const OfLinks& constants, const double* y,
                                                 double sigma, int order, Torque& torque) {
  DoublePendulumOrders<double>::Last last;
  DoublePendulumOrders<double> orders(constants, y, sigma, torque, states, last);
  complete(orders, order, torque, states, last);
  const Pair start = load<Pair>(y);
  Pair s0, c0;
  sine_cosine(start, s0, c0);
  for (int i = 0; i < 2; ++i) {
    across_[i][0] = 1.0;
    along_[i][1] = orders.minus_rate[i];
    for (int k = 2; k < order + 2; ++k) {
      along_[i][k] = orders.n[k][i];
      across_[i][k] = orders.n[k][2 + i];
    }
    for (int k = 0; k <= order; ++k) rate[i][k] = orders.rates[k][i];
  }
  const double sin = fma(s0[1], c0[0], -(c0[1] * s0[0]));  // of q_2 - q_1
  const double cos = fma(c0[1], c0[0], s0[1] * s0[0]);
  find_products(cos, sin, order);
  kappa = constants.coupling * cos - constants.rotor;
  inverse = orders.inverse[0];
  store(states, load<Pack<4>>(y));

  for (int first = 0; first < order; first += width) {
    const Orders both_by_cos = product(rate[0], rate_by_cos_[1], first);
    const Orders both_by_sin = product(rate[0], rate_by_sin_[1], first);
    second_[0].set_eight(first, -of_derivative(rate_by_sin_[1], first) - both_by_cos);
    second_[1].set_eight(first, of_derivative(rate_by_sin_[0], first) - both_by_cos);
    store(bend[0].data() + first, Orders(of_derivative(rate_by_cos_[1], first) - both_by_sin));
    store(bend[1].data() + first, Orders(of_derivative(rate_by_cos_[0], first) + both_by_sin));
    for (int i = 0; i < 2; ++i) {
      const Orders x = along_[i].eight(first);
      const Orders y_of_n = across_[i].eight(first);
      const Orders sine_of_q = sigma * sigma * fma(s0[i], y_of_n, -(c0[i] * x));
      store(sine[i].data() + first, sine_of_q);
      store(cosine[i].data() + first, Orders(sigma * sigma * fma(s0[i], x, c0[i] * y_of_n)));
      store(pull[i].data() + first, fma(constants.coupling[i], second_[i].eight(first),
                                        -(constants.weight[i] * sine_of_q)));
      store(acceleration[i].data() + first, of_derivative(rate[i], first));
      angle[i][0] = start[i];
      store(angle[i].data() + first + 1, Orders(one_over(first + 1) * rate[i].eight(first)));
    }
  }
  for (int i = 0; i < 2; ++i) {
    const double rho = constants.coupling[i];
    const double of_first = i == 0 ? -2.0 : 2.0;
    for (int first = 0; first <= order; first += width) {
      const Orders m = from(first) - 1.0;
      const Orders square = -rho * cos_.eight(first + 1);
      const Orders of_rate = of_first * rate_by_sin_[1 - i].eight(first);  // 2 n.N_t
      const Orders next_m = from(first);
      store(of_angle[i].square.data() + first, square);
      store(of_angle[i].slope.data() + first, Orders(-fma(m + next_m, square, rho * of_rate)));
      store(of_angle[i].constant.data() + first,
            fma(m * next_m, square, rho * fma(m, of_rate, -second_[i].eight(first - 1))));
    }
  }
}

}  // namespace pendcore
