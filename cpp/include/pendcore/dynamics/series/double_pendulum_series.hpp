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
#include "pendcore/arithmetic/row_of_pairs.hpp"
#include "pendcore/arithmetic/sine_cosine.hpp"
#include "pendcore/dynamics/series/torque_series.hpp"

namespace pendcore {

/// What a series is made of: numbers, pairs of them, and rows of two pairs. `Number` is a double,
/// or a pack with one trajectory a lane.
template <class Number>
struct SeriesOf {
  using Half = PairOf<Number>;
  using Row = TwoPairs<Number>;
  PENDCORE_INLINE static Half pair_at(const Number* from) { return {from[0], from[1]}; }
  PENDCORE_INLINE static void put_row(Number* to, const Row& row) {
    to[0] = row.first.first;
    to[1] = row.first.second;
    to[2] = row.second.first;
    to[3] = row.second.second;
  }
};
template <>
struct SeriesOf<double> {
  using Half = PairOf<double>;
  using Row = Pairs;
  PENDCORE_INLINE static Half pair_at(const double* from) { return load<Pair>(from); }
  PENDCORE_INLINE static void put_row(double* to, const Row& row) { store(to, row); }
};

/// The constants that double_pendulum.hpp and double_pendulum_with_effects.hpp have in common.
template <class Number>
struct ConstantsOfDoublePendulum {
  using Half = typename SeriesOf<Number>::Half;

  Half weight;     ///< gamma
  Half coupling;   ///< rho
  Half rotor;      ///< J_2/A
  Number product;  ///< rho rho'
  Number delta;
  Number epsilon;
};
using DoublePendulumConstants = ConstantsOfDoublePendulum<double>;

/// A state is one row: (q_1, q_2, qd_1, qd_2).
template <class Torque>
class DoublePendulumSeries {
 public:
  using Block = Pack<4>;
  static constexpr int blocks = 1;
  static constexpr bool is_short = !Torque::is_there;  ///< bare, without a torque
  static constexpr InstructionSet best = best_for(is_short ? 4 : 2);
  /// Where it has no clone, series_with_holds.hpp has the same bits.
  static constexpr InstructionSet least =
      is_short ? InstructionSet::baseline : least_of_special_kernels;

  DoublePendulumSeries(const DoublePendulumConstants& constants, Torque torque)
      : constants_(constants), torque_(std::move(torque)) {}

  static constexpr int row() { return 2; }
  static constexpr int links() { return 2; }
  static constexpr bool depends_on_time() { return Torque::is_there; }
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
template <class Number>
struct DoublePendulumOrders {
  using Of = SeriesOf<Number>;
  using Half = typename Of::Half;
  using Row = typename Of::Row;

  Number per_sigma;
  Row own, cross;  ///< 1/D and -kappa/D of the two by two system
  Row pull;        ///< gamma sigma^2, the factor of c
  Row minus_rho;
  Row n0, n1, n2, rate0, rate1;
  // Factors in f, in which the halves of a row are added: (k + 1) (first + k second) of u_{k+1},
  // and (k + 1) by_rest of the terms of older orders in u_{k+2}.
  Row first, second, by_rest;
  Row by_rate[2];         ///< factor of qd_k: [0] + k [1]
  Row by_rate_before[2];  ///< factor of qd_{k-1}: [0] + k [1]
  Row by_u[3];            ///< factor of u_k of the other link: [0] + k [1] + k^2 [2]
  Row by_own_u;

  // What the last two orders leave for the next. Even and odd orders have a place each, so that
  // nothing moves from one place to another.
  Row u[2];                            ///< u_k and u_{k+1}
  Row rate[2];                         ///< qd_{k-1} and qd_k; 0 instead of qd_0, which is in rate0
  Row rest_before;                     ///< the terms of older orders in u_{k+1}
  Row u_without_rate;                  ///< u_{k+1} without its term in qd_k
  Half angle_of_order, rate_of_order;  ///< q_k and qd_k

  Row pulls[highest_order];  ///< -rho u'' of the other link
  Row n[highest_order + 3];
  Row rates[highest_order + 1];

  PENDCORE_INLINE DoublePendulumOrders(const ConstantsOfDoublePendulum<Number>& constants,
                                       const Number* y, const Number& sigma);
  /// Computes orders 0, 1 and 2, whose sums are too short to have last terms apart from others.
  template <class TorqueOrders>
  PENDCORE_INLINE void begin(TorqueOrders& torque, Number* coefficients);
  /// Computes order k >= 3 from the older terms of both sums: pulls_j n_{k-j} from j = 1 to k - 3,
  /// and qd_j n_{k+1-j} from j = 2 to k - 2. `odd` is k % 2.
  template <int odd, class TorqueOrders>
  PENDCORE_INLINE void next(int k, const Row& sum, const Row& rest, TorqueOrders& torque,
                            Number* coefficients);

 private:
  template <int k, class TorqueOrders>
  PENDCORE_INLINE void first_order(TorqueOrders& torque, Number* coefficients);
  PENDCORE_INLINE void put_factors_together();
  /// Computes order k from f without the part of qd_k, and from the terms of older orders in
  /// u_{k+2}.
  template <int odd, class TorqueOrders>
  PENDCORE_INLINE void finish(int k, Row f, const Row& rest, TorqueOrders& torque,
                              Number* coefficients);
};

template <class Number>
PENDCORE_INLINE DoublePendulumOrders<Number>::DoublePendulumOrders(
    const ConstantsOfDoublePendulum<Number>& constants, const Number* y, const Number& sigma) {
  per_sigma = 1.0 / sigma;  // exact: a power of two
  Half s0, c0;
  sine_cosine(Of::pair_at(y), s0, c0);
  angle_of_order = Of::pair_at(y);
  rate_of_order = sigma * Of::pair_at(y + 2);
  const Half sine = fma(s0, other(c0), -(c0 * other(s0)));
  const Half cosine = fma(c0, other(c0), s0 * other(s0));
  const Half rest =
      fma(Constants<Half>::of(constants.epsilon), cosine, Constants<Half>::of(constants.delta));
  const Half inverse = 1.0 / fma(constants.product * sine, sine, rest);
  own = twice(inverse);
  cross = twice(fma(Half(-constants.coupling), cosine, constants.rotor) * inverse);
  pull = joined(Half(sigma * sigma * constants.weight), Half{});
  minus_rho = twice(-constants.coupling);
  rate0 = twice(rate_of_order);
  u[0] = joined(c0, s0);
  n0 = turned(u[0]);
  u[1] = rate0 * n0;
  n1 = turned(u[1]);
  first = minus_rho * other(rate0) * u[0];
  second = minus_rho * n1;
  by_rest = minus_rho * n0;
  const Row direct = by_rest * other(n1);
  by_rate[0] = halves_added(fma(first, other(n0), direct));
  by_rate[1] = halves_added(fma(second, other(n0), direct));
  u_without_rate = u[1];
  rate[0] = rate[1] = rest_before = Row{};
  n[1] = n1;
  rates[0] = rate0;
}

/// Computes the factors of u_k and qd_{k-1} that come from u_{k+1} = (qd_0 n_k + qd_{k-1} n_1 +
/// rest + qd_k n_0)/(k + 1) and from the last terms of both sums. n_k is u_k turned; where the
/// halves are added, a row times a turned row is minus the turned first row times the second.
template <class Number>
PENDCORE_INLINE void DoublePendulumOrders<Number>::put_factors_together() {
  n2 = n[2];
  rate1 = rates[1];
  by_own_u = pull - turned(pulls[0]);
  const Row of_pulls = minus_rho * n2;
  const Row of_rest = -turned(by_rest * other(rate1));
  by_u[0] = of_rest - turned(first * other(rate0));
  by_u[1] = (of_rest - of_pulls) - turned(second * other(rate0));
  by_u[2] = of_pulls;
  const Row direct = by_rest * other(n2);
  by_rate_before[0] = halves_added(fma(first, other(n1), direct));
  by_rate_before[1] = halves_added(fma(second, other(n1), direct));
}

template <class Number>
template <int k, class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders<Number>::first_order(TorqueOrders& torque,
                                                               Number* coefficients) {
  Row rest{};
  Row sum{};
  if constexpr (k == 2) {
    rest = rates[1] * n[2];
    sum = pulls[0] * n[2];
  }
  constexpr double next = k + 1.0;
  const Row by = next * fma(Constants<Row>::of(static_cast<double>(k)), second, first);
  const Row older = fma(Row(next * by_rest), other(rest), fma(pull, u[k % 2], sum));
  finish<k % 2>(k, halves_added(fma(by, other(u_without_rate), older)), rest, torque,
                coefficients);
}

template <class Number>
template <class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders<Number>::begin(TorqueOrders& torque,
                                                         Number* coefficients) {
  first_order<0>(torque, coefficients);
  first_order<1>(torque, coefficients);
  first_order<2>(torque, coefficients);
  put_factors_together();
}

template <class Number>
template <int odd, class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders<Number>::next(int k, const Row& sum, const Row& rest,
                                                        TorqueOrders& torque,
                                                        Number* coefficients) {
  const Row order = Constants<Row>::of(static_cast<double>(k));
  const Row by = fma(order, second, first);
  const Row older = fma(Row((k + 1.0) * by_rest), other(rest), fma(by, other(rest_before), sum));
  const Row of_u = fma(order, fma(order, by_u[2], by_u[1]), by_u[0]);
  const Row of_rate = fma(order, by_rate_before[1], by_rate_before[0]);
  const Row known = fma(of_u, other(u[odd]), fma(by_own_u, u[odd], older));
  finish<odd>(k, fma(of_rate, other(rate[1 - odd]), halves_added(known)),
              fma(rates[k - 1], n2, fma(rate1, n[k], rest)), torque, coefficients);
}

template <class Number>
template <int odd, class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders<Number>::finish(int k, Row f, const Row& rest,
                                                          TorqueOrders& torque,
                                                          Number* coefficients) {
  const double share = inverse_of[k + 1];
  const double share_after = inverse_of[k + 2];
  if constexpr (!std::is_same_v<TorqueOrders, NoTorque>) {
    f = f + twice(torque.next(k, angle_of_order, rate_of_order));
  }
  const Row own_share = share * own;
  const Row cross_share = share * cross;
  const Row of_rate = fma(Constants<Row>::of(static_cast<double>(k)), by_rate[1], by_rate[0]);
  const Row without_rate = fma(cross_share, other(f), own_share * f);
  const Row rate_after = fma(Row(own_share * of_rate), other(rate[odd]),
                             fma(Row(cross_share * other(of_rate)), rate[odd], without_rate));
  u_without_rate = share_after * fma(rate0, n[k + 1], fma(n1, rate[odd], rest));
  const Row u_after = fma(Row(share_after * n0), rate_after, u_without_rate);

  angle_of_order = share * rate_of_order;
  rate_of_order = low_half(rate_after);
  Of::put_row(coefficients + static_cast<std::ptrdiff_t>(4) * (k + 1),
              joined(angle_of_order, Half(per_sigma * rate_of_order)));
  pulls[k] = ((k + 1.0) * (k + 2.0) * minus_rho) * other(u_after);
  n[k + 2] = turned(u_after);
  rates[k + 1] = rate_after;
  u[odd] = u_after;
  rest_before = rest;
  rate[1 - odd] = rate_after;
}

/// The older terms of both sums of orders k and k + 1: what `next` takes. Two orders are computed
/// at a time, so that what they share is loaded once.
template <class Row>
struct OlderTerms {
  Row sum, rest, next_sum, next_rest;
};

/// Adds up these terms of numbers, or of packs, that `pull(j)`, `rate(j)` and `n(j)` return.
template <class Value, class Pull, class Rate, class Normal>
PENDCORE_INLINE OlderTerms<Value> older_terms(int k, const Pull& pull, const Rate& rate,
                                              const Normal& n) {
  Value sum{}, sum_even{}, rest{}, rest_even{};  // sums of order k over odd and even j
  Value next_sum{}, next_sum_even{}, next_rest{}, next_rest_even{};
  Value n_before = n(k);
  for (int j = 1; j < k - 3; j += 2) {
    const Value n_here = n(k - j);
    const Value n_after = n(k - j - 1);
    const Value pull_here = pull(j);
    const Value pull_after = pull(j + 1);
    const Value rate_here = rate(j + 1);
    const Value rate_after = rate(j + 2);
    sum = fma(pull_here, n_here, sum);
    rest = fma(rate_here, n_here, rest);
    next_sum = fma(pull_here, n_before, next_sum);
    next_rest = fma(rate_here, n_before, next_rest);
    sum_even = fma(pull_after, n_after, sum_even);
    rest_even = fma(rate_after, n_after, rest_even);
    next_sum_even = fma(pull_after, n_here, next_sum_even);
    next_rest_even = fma(rate_after, n_here, next_rest_even);
    n_before = n_after;
  }
  const Value n_last = n(3);
  sum = fma(pull(k - 3), n_last, sum);
  rest = fma(rate(k - 2), n_last, rest);
  next_sum = fma(pull(k - 3), n_before, next_sum);
  next_rest = fma(rate(k - 2), n_before, next_rest);
  next_sum_even = fma(pull(k - 2), n_last, next_sum_even);
  next_rest_even = fma(rate(k - 1), n_last, next_rest_even);
  return {sum + sum_even, rest + rest_even, next_sum + next_sum_even, next_rest + next_rest_even};
}

PENDCORE_INLINE OlderTerms<Pairs> older_terms(const DoublePendulumOrders<double>& orders, int k) {
  return older_terms<Pairs>(
      k, [&](int j) __attribute__((always_inline)) { return orders.pulls[j]; },
      [&](int j) __attribute__((always_inline)) { return orders.rates[j]; },
      [&](int j) __attribute__((always_inline)) { return orders.n[j]; });
}
/// In lanes, the numbers of a row are added up one after the other: the sums of a whole row would
/// not fit into the registers.
template <class Real>
PENDCORE_INLINE OlderTerms<TwoPairs<Real>> older_terms(const DoublePendulumOrders<Real>& orders,
                                                       int k) {
  OlderTerms<TwoPairs<Real>> terms;
  const auto add = [&](auto half, auto one) __attribute__((always_inline)) {
    const OlderTerms<Real> found = older_terms<Real>(
        k, [&](int j) __attribute__((always_inline)) { return orders.pulls[j].*half.*one; },
        [&](int j) __attribute__((always_inline)) { return orders.rates[j].first.*one; },
        [&](int j) __attribute__((always_inline)) { return orders.n[j].*half.*one; });
    terms.sum.*half.*one = found.sum;
    terms.rest.*half.*one = found.rest;
    terms.next_sum.*half.*one = found.next_sum;
    terms.next_rest.*half.*one = found.next_rest;
  };
  add(&TwoPairs<Real>::first, &Two<Real>::first);
  add(&TwoPairs<Real>::first, &Two<Real>::second);
  add(&TwoPairs<Real>::second, &Two<Real>::first);
  add(&TwoPairs<Real>::second, &Two<Real>::second);
  return terms;
}

/// Fills rows 1 .. order of `coefficients` with the series from the state y, a row of four numbers,
/// in units of sigma. `torque` gives the series of the torques.
template <class Number, class TorqueOrders>
PENDCORE_INLINE void expand_double_pendulum(const ConstantsOfDoublePendulum<Number>& constants,
                                            const Number* y, const Number& sigma, int order,
                                            TorqueOrders& torque, Number* coefficients) {
  using Row = typename SeriesOf<Number>::Row;
  DoublePendulumOrders<Number> orders(constants, y, sigma);
  orders.begin(torque, coefficients);
  orders.template next<1>(3, Row{}, Row{}, torque, coefficients);
  for (int k = 4; k < order; k += 2) {
    const OlderTerms<Row> older = older_terms(orders, k);
    orders.template next<0>(k, older.sum, older.rest, torque, coefficients);
    orders.template next<1>(k + 1, older.next_sum, older.next_rest, torque, coefficients);
  }
}

template <class Torque>
PENDCORE_INLINE void DoublePendulumSeries<Torque>::expand(double t, const double* y, double sigma,
                                                          int order, double* coefficients) const {
  if constexpr (Torque::is_there) {
    const TorqueLaws<Pair, double> laws = torque_laws(*torque_.effects, torque_.factor);
    typename Torque::Orders orders(laws, t, sigma);
    expand_double_pendulum(constants_, y, sigma, order, orders, coefficients);
  } else {
    NoTorque none;
    expand_double_pendulum(constants_, y, sigma, order, none, coefficients);
  }
}

}  // namespace pendcore
