/// \file
/// The equations of the textbook's double pendulum as recurrences of Taylor series: they give q and
/// qd to any order from one state.
///
/// Each link has u = (cos q, sin q) along it and n = (-sin q, cos q) across it, so that u' = qd n.
/// The equations of double_pendulum.hpp, divided by their A_ii, read for both links at once (x' is
/// a quantity of the other link, rho = A_12/A, gamma = a g/A)
///
///     qdd + rho n . u''(other) = gamma cos q
///
/// With x_k the coefficient of theta^k, sums over j, and time in units of sigma:
///
///     (k + 2) u_{k+2} = sum_{j<=k+1} qd_j n_{k+1-j}  =  qd_{k+1} n_0 + v
///     (k + 1) qd_{k+1} + rho sum_{j<=k} n_{k-j} . u''_j(other) = gamma c_k
///
/// Here v is the rest of that sum, j <= k. In units of sigma, gamma is sigma^2 a g/A.
///
/// The newest u''_k contains the unknown qd_{k+1}. Because n_0 . n_0(other) = cos(q - q') = C, the
/// unknowns of both links solve the two by two system of the equations themselves, the same for
/// every order:
///
///     alpha + kappa alpha' = f,   alpha = (k + 1) qd_{k+1}:   alpha = (f - kappa f') / D
///     f = gamma c_k - rho ((k + 1) n_0 . v(other) + sum_{j<k} n_{k-j} . u''_j(other))
///
/// Here kappa = rho C - J_2/A and D = 1 - kappa kappa', with J_2 the rotor in joint 2 (the sigma of
/// double_pendulum_with_effects.hpp is J_2/A). Torques on the joints add to f; a `Torque` computes
/// their series (torque_series.hpp). The bare pendulum has none.
///
/// No sine, cosine, product or quotient needs a series of its own: each order is two sums of
/// products of rows of four, (c, c', s, s').
///
/// The time of an order is mostly the time that it waits for the orders before it. The last of
/// them, qd_k, is in u_{k+1}; the one before it is in u_k and qd_{k-1}. Each multiplies factors
/// that the start of the step determines, and k and k^2. With these factors computed once in a
/// step, order k + 1 is
///
///     qd_{k+1} = older + by_u (u_k, u_k') + by_rate_before qd_{k-1}' + by_rate (qd_k, qd_k')
///
/// instead of f. `older` has all terms of the two sums but the last ones, and is known long before.
///
/// Source: the recurrences of automatic differentiation (Moore, Interval Analysis, 1966, chapter
/// 11; Jorba and Zou, Exp. Math. 14, 2005); the elimination is this project's.
/// Cost: a sine and cosine of a pair, a division, and for order p some p^2/2 pairs of products.
#pragma once

#include <type_traits>
#include <utility>

#include "pendcore/arithmetic/order_of_series.hpp"
#include "pendcore/arithmetic/pair.hpp"
#include "pendcore/arithmetic/sine_cosine.hpp"

namespace pendcore {

/// The bare pendulum has no torque but gravity's.
struct NoTorque {
  static constexpr bool is_there = false;
  static constexpr bool depends_on_time = false;
};

/// The constants that double_pendulum.hpp and double_pendulum_with_effects.hpp have in common.
struct DoublePendulumConstants {
  Pair weight;     ///< gamma
  Pair coupling;   ///< rho
  Pair rotor;      ///< J_2/A
  double product;  ///< rho rho'
  double delta;
  double epsilon;
};

/// A state is one row: (q_1, q_2, qd_1, qd_2).
template <class Torque>
class DoublePendulumSeries {
 public:
  using Block = Pack<4>;
  static constexpr int blocks = 1;
  static constexpr bool depends_on_time = Torque::depends_on_time;
  static constexpr bool is_short = !depends_on_time;  ///< bare, without a torque
  static constexpr InstructionSet best = best_for(is_short ? 4 : 2);
  /// Where it has no clone, series_with_holds.hpp has the same bits.
  static constexpr InstructionSet least =
      is_short ? InstructionSet::baseline : least_of_special_kernels;

  DoublePendulumSeries(const DoublePendulumConstants& constants, Torque torque)
      : constants_(constants), torque_(std::move(torque)) {}

  static constexpr int row() { return 2; }
  static constexpr int links() { return 2; }
  void set_order(int /*order*/) {}

  /// Fills rows 1 .. order of `coefficients` with y_k of y(t + theta sigma) = sum_k theta^k y_k,
  /// from the state y. The order is even, and at least `lowest_order`.
  PENDCORE_INLINE void expand(double t, const double* y, double sigma, int order,
                              double* coefficients) const;

 private:
  DoublePendulumConstants constants_;
  Torque torque_;
};

/// The orders of one series. Rows are (c, c', s, s'); for rates and other numbers without a
/// direction, a row is the pair twice.
struct DoublePendulumOrders {
  double per_sigma;
  Pairs own, cross;  ///< 1/D and -kappa/D of the two by two system
  Pairs pull;        ///< gamma sigma^2, the factor of c
  Pairs minus_rho;
  Pairs n0, n1, n2, rate0, rate1;
  // Factors in f, in which the halves of a row are added: (k + 1) (first + k second) of u_{k+1},
  // and (k + 1) by_rest of the terms of older orders in u_{k+2}.
  Pairs first, second, by_rest;
  Pairs by_rate[2];         ///< factor of qd_k: [0] + k [1]
  Pairs by_rate_before[2];  ///< factor of qd_{k-1}: [0] + k [1]
  Pairs by_u[3];            ///< factor of u_k of the other link: [0] + k [1] + k^2 [2]
  Pairs by_own_u;

  // What the last two orders leave for the next.
  Pairs u_before, u;                   ///< u_k and u_{k+1}
  Pairs rate_before, rate;             ///< qd_{k-1} and qd_k; 0 instead of qd_0, which is in rate0
  Pairs rest_before;                   ///< the terms of older orders in u_{k+1}
  Pairs u_without_rate;                ///< u_{k+1} without its term in qd_k
  Pair angle_of_order, rate_of_order;  ///< q_k and qd_k

  Pairs pulls[highest_order];  ///< -rho u'' of the other link
  Pairs n[highest_order + 3];
  Pairs rates[highest_order + 1];

  PENDCORE_INLINE DoublePendulumOrders(const DoublePendulumConstants& constants, const double* y,
                                       double sigma);
  /// Computes orders 0, 1 and 2, whose sums are too short to have last terms apart from others.
  template <class TorqueOrders>
  PENDCORE_INLINE void begin(TorqueOrders& torque, double* coefficients);
  /// Computes order k >= 3 from the older terms of both sums: pulls_j n_{k-j} from j = 1 to k - 3,
  /// and qd_j n_{k+1-j} from j = 2 to k - 2.
  template <class TorqueOrders>
  PENDCORE_INLINE void next(int k, const Pairs& sum, const Pairs& rest, TorqueOrders& torque,
                            double* coefficients);

 private:
  PENDCORE_INLINE void put_factors_together();
  /// Computes order k from f without the part of qd_k, and from the terms of older orders in
  /// u_{k+2}.
  template <class TorqueOrders>
  PENDCORE_INLINE void finish(int k, Pairs f, const Pairs& rest, TorqueOrders& torque,
                              double* coefficients);
};

PENDCORE_INLINE DoublePendulumOrders::DoublePendulumOrders(const DoublePendulumConstants& constants,
                                                           const double* y, double sigma) {
  per_sigma = 1.0 / sigma;  // exact: a power of two
  Pair s0, c0;
  sine_cosine(load<Pair>(y), s0, c0);
  angle_of_order = load<Pair>(y);
  rate_of_order = sigma * load<Pair>(y + 2);
  const Pair sine = fma(s0, other(c0), -(c0 * other(s0)));
  const Pair cosine = fma(c0, other(c0), s0 * other(s0));
  const Pair rest =
      fma(broadcast<Pair>(constants.epsilon), cosine, broadcast<Pair>(constants.delta));
  const Pair inverse = 1.0 / fma(constants.product * sine, sine, rest);
  own = twice(inverse);
  cross = twice(fma(Pair(-constants.coupling), cosine, constants.rotor) * inverse);
  pull = joined(Pair(sigma * sigma * constants.weight), Pair{});
  minus_rho = twice(-constants.coupling);
  rate0 = twice(rate_of_order);
  u_before = joined(c0, s0);
  n0 = turned(u_before);
  u = rate0 * n0;
  n1 = turned(u);
  first = minus_rho * other(rate0) * u_before;
  second = minus_rho * n1;
  by_rest = minus_rho * n0;
  const Pairs direct = by_rest * other(n1);
  by_rate[0] = halves_added(fma(first, other(n0), direct));
  by_rate[1] = halves_added(fma(second, other(n0), direct));
  u_without_rate = u;
  rate_before = rate = rest_before = Pairs{};
  n[1] = n1;
  rates[0] = rate0;
}

/// Computes the factors of u_k and qd_{k-1} that come from u_{k+1} = (qd_0 n_k + qd_{k-1} n_1 +
/// rest + qd_k n_0)/(k + 1) and from the last terms of both sums. n_k is u_k turned; where the
/// halves are added, a row times a turned row is minus the turned first row times the second.
PENDCORE_INLINE void DoublePendulumOrders::put_factors_together() {
  n2 = n[2];
  rate1 = rates[1];
  by_own_u = pull - turned(pulls[0]);
  const Pairs of_pulls = minus_rho * n2;
  const Pairs of_rest = -turned(by_rest * other(rate1));
  by_u[0] = of_rest - turned(first * other(rate0));
  by_u[1] = (of_rest - of_pulls) - turned(second * other(rate0));
  by_u[2] = of_pulls;
  const Pairs direct = by_rest * other(n2);
  by_rate_before[0] = halves_added(fma(first, other(n1), direct));
  by_rate_before[1] = halves_added(fma(second, other(n1), direct));
}

template <class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders::begin(TorqueOrders& torque, double* coefficients) {
  Pairs rest{};
  Pairs sum{};
#pragma GCC unroll 3
  for (int k = 0; k <= 2; ++k) {
    if (k == 2) {
      rest = rates[1] * n[2];
      sum = pulls[0] * n[2];
    }
    const double next = k + 1.0;
    const Pairs by = next * fma(broadcast<Pairs>(k), second, first);
    const Pairs older = fma(Pairs(next * by_rest), other(rest), fma(pull, u_before, sum));
    finish(k, halves_added(fma(by, other(u_without_rate), older)), rest, torque, coefficients);
  }
  put_factors_together();
}

template <class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders::next(int k, const Pairs& sum, const Pairs& rest,
                                                TorqueOrders& torque, double* coefficients) {
  const Pairs order = broadcast<Pairs>(k);
  const Pairs by = fma(order, second, first);
  const Pairs older =
      fma(Pairs((k + 1.0) * by_rest), other(rest), fma(by, other(rest_before), sum));
  const Pairs of_u = fma(order, fma(order, by_u[2], by_u[1]), by_u[0]);
  const Pairs of_rate = fma(order, by_rate_before[1], by_rate_before[0]);
  const Pairs known = fma(of_u, other(u_before), fma(by_own_u, u_before, older));
  finish(k, fma(of_rate, other(rate_before), halves_added(known)),
         fma(rates[k - 1], n2, fma(rate1, n[k], rest)), torque, coefficients);
}

template <class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders::finish(int k, Pairs f, const Pairs& rest,
                                                  TorqueOrders& torque, double* coefficients) {
  const double share = inverse_of[k + 1];
  const double share_after = inverse_of[k + 2];
  if constexpr (!std::is_same_v<TorqueOrders, NoTorque>) {
    f = f + twice(torque.next(k, angle_of_order, rate_of_order));
  }
  const Pairs own_share = share * own;
  const Pairs cross_share = share * cross;
  const Pairs of_rate = fma(broadcast<Pairs>(k), by_rate[1], by_rate[0]);
  const Pairs without_rate = fma(cross_share, other(f), own_share * f);
  const Pairs rate_after = fma(Pairs(own_share * of_rate), other(rate),
                               fma(Pairs(cross_share * other(of_rate)), rate, without_rate));
  u_without_rate = share_after * fma(rate0, n[k + 1], fma(n1, rate, rest));
  const Pairs u_after = fma(Pairs(share_after * n0), rate_after, u_without_rate);

  angle_of_order = share * rate_of_order;
  rate_of_order = low_half(rate_after);
  store(coefficients + static_cast<std::ptrdiff_t>(4) * (k + 1),
        joined(angle_of_order, Pair(per_sigma * rate_of_order)));
  pulls[k] = ((k + 1.0) * (k + 2.0) * minus_rho) * other(u_after);
  n[k + 2] = turned(u_after);
  rates[k + 1] = rate_after;
  u_before = u;
  u = u_after;
  rest_before = rest;
  rate_before = rate;
  rate = rate_after;
}

template <class Torque>
PENDCORE_INLINE void DoublePendulumSeries<Torque>::expand(double t, const double* y, double sigma,
                                                          int order, double* coefficients) const {
  DoublePendulumOrders orders(constants_, y, sigma);
  auto torque = [&] {
    if constexpr (Torque::is_there) {
      return typename Torque::Orders(torque_, t, sigma);
    } else {
      return torque_;
    }
  }();
  orders.begin(torque, coefficients);
  orders.next(3, Pairs{}, Pairs{}, torque, coefficients);
  // Two orders are computed at a time, so that what they share is loaded once.
  for (int k = 4; k < order; k += 2) {
    Pairs sum{}, sum_even{}, rest{}, rest_even{};  // sums of order k over odd and even j
    Pairs next_sum{}, next_sum_even{}, next_rest{}, next_rest_even{};
    Pairs n_before = orders.n[k];
    for (int j = 1; j < k - 3; j += 2) {
      const Pairs n = orders.n[k - j];
      const Pairs n_after = orders.n[k - j - 1];
      const Pairs pull = orders.pulls[j];
      const Pairs pull_after = orders.pulls[j + 1];
      const Pairs rate = orders.rates[j + 1];
      const Pairs rate_after = orders.rates[j + 2];
      sum = fma(pull, n, sum);
      rest = fma(rate, n, rest);
      next_sum = fma(pull, n_before, next_sum);
      next_rest = fma(rate, n_before, next_rest);
      sum_even = fma(pull_after, n_after, sum_even);
      rest_even = fma(rate_after, n_after, rest_even);
      next_sum_even = fma(pull_after, n, next_sum_even);
      next_rest_even = fma(rate_after, n, next_rest_even);
      n_before = n_after;
    }
    const Pairs n = orders.n[3];
    sum = fma(orders.pulls[k - 3], n, sum);
    rest = fma(orders.rates[k - 2], n, rest);
    next_sum = fma(orders.pulls[k - 3], n_before, next_sum);
    next_rest = fma(orders.rates[k - 2], n_before, next_rest);
    next_sum_even = fma(orders.pulls[k - 2], n, next_sum_even);
    next_rest_even = fma(orders.rates[k - 1], n, next_rest_even);
    orders.next(k, Pairs(sum + sum_even), Pairs(rest + rest_even), torque, coefficients);
    orders.next(k + 1, Pairs(next_sum + next_sum_even), Pairs(next_rest + next_rest_even), torque,
                coefficients);
  }
}

}  // namespace pendcore
