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
///     u''_k = alpha n_0 + beta,   alpha = (k + 1) qd_{k+1},   beta = (k + 1) v
///     alpha = f - kappa f'
///     D f   = gamma c_k - rho (n_0 . beta' + sum_{j<k} n_{k-j} . u''_j')
///
/// Here kappa = rho C - J_2/A and D = 1 - kappa kappa', with J_2 the rotor in joint 2 (the sigma of
/// double_pendulum_with_effects.hpp is J_2/A). Torques on the joints, over D, add to f; a `Torque`
/// computes their series (torque_series.hpp). The bare pendulum has none.
///
/// The vectors of a link are written along its own axes at the start of the step, (u_0, n_0). There
/// n_0 = (0, 1) and n_1 = (-qd_0, 0), so that alpha is in one component alone, and the terms of the
/// sums that hold qd_0 and n_1 are known in closed form. With along and across, the rest of both
/// sums (terms_by_age.hpp), S = sin(q' - q), and [k-1] for the order before:
///
///     beta_x = (k + 1) along_x - qd_0/k beta_y[k-1] - (k + 2)/k qd_0 alpha[k-1]
///     beta_y = (k + 1) along_y + qd_0/k beta_x[k-1]
///     f      = across - rho/D (S beta_x' + C beta_y') - qd_0 pull_x[k-1]
///     pull   = -rho/D (C u''_x' - S u''_y', S u''_x' + C u''_y')
///     n_{k+2} = (-u''_y, u''_x)/((k + 1)(k + 2))
///
/// The weight is a pull like that of the other link: gamma c_k is n_k times gamma (s_0, c_0), which
/// over D is added to the pull of order 0.
///
/// No sine, cosine, product or quotient needs a series of its own: each order is two sums of
/// products of rows of four, (x, x', y, y').
///
/// What bounds a single run is how long an order waits for the one before: from alpha[k-1] by
/// beta_x or pull_x to f and to alpha there are five operations and two exchanges of links, some 22
/// cycles, beside which go some 35 operations and the sums. If nothing waited, a step of order 18
/// would take 0.88 of its time. What bounds a trajectory in lanes is the number of operations: an
/// order has 44 beside the sums, 4 less than along axes that all links share.
///
/// Source: the recurrences of automatic differentiation (Moore, Interval Analysis, 1966, chapter
/// 11; Jorba and Zou, Exp. Math. 14, 2005); the elimination is this project's.
/// Cost: a sine and cosine of a pair, a division, and for order p some p^2/2 pairs of products.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

#include "arithmetic/order_of_series.hpp"
#include "arithmetic/pair.hpp"
#include "arithmetic/power.hpp"
#include "arithmetic/row_of_pairs.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/series/terms_by_age.hpp"
#include "dynamics/series/torque_series.hpp"

namespace pendcore {

/// What a series is made of: numbers, pairs of them, and rows of two pairs. `Number` is a double, a
/// dual number, or a pack with one trajectory a lane.
template <class Number>
struct SeriesOf {
  using Half = PairOf<Number>;
  using Row = TwoPairs<Number>;
  PENDCORE_INLINE static Half pair_at(const Number* from) { return {from[0], from[1]}; }
  using Rate = Half;
  PENDCORE_INLINE static Rate rate(const Half& x) { return x; }
  PENDCORE_INLINE static Half pair(const Rate& x) { return x; }
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
  using Rate = Row;
  PENDCORE_INLINE static Rate rate(const Half& x) { return twice(x); }
  PENDCORE_INLINE static Half pair(const Rate& x) { return low_half(x); }
  PENDCORE_INLINE static Half pair_at(const double* from) { return load<Pair>(from); }
  PENDCORE_INLINE static void put_row(double* to, const Row& row) { store(to, row); }
};

template <>
struct SeriesOf<Dual<double>> {
  using Half = Dual<Pair>;
  using Row = Dual<Pairs>;
  using Rate = Row;
  PENDCORE_INLINE static Rate rate(const Half& x) { return twice(x); }
  PENDCORE_INLINE static Half pair(const Rate& x) { return low_half(x); }
  PENDCORE_INLINE static Half pair_at(const Dual<double>* from) { return load<Half>(from); }
  PENDCORE_INLINE static void put_row(Dual<double>* to, const Row& row) { store(to, row); }
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

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.weight, x.coupling, x.rotor, x.product, x.delta, x.epsilon);
  }
};
using DoublePendulumConstants = ConstantsOfDoublePendulum<double>;

/// A state is one row: (q_1, q_2, qd_1, qd_2).
template <class Torque>
class DoublePendulumSeries {
 public:
  using Block = Pack<4>;
  static constexpr int blocks = 1;
  static constexpr bool is_short = !Torque::is_there;  ///< bare, without a torque
  static constexpr Sets sets = is_short ? wide_sets : special_sets;

  DoublePendulumSeries(const DoublePendulumConstants& constants, Torque torque)
      : constants_(constants), torque_(std::move(torque)) {}

  static constexpr int row() { return 2; }
  static constexpr int links() { return 2; }
  static constexpr bool depends_on_time() { return Torque::is_there; }
  void set_order(int /*order*/) {}

  const DoublePendulumConstants& constants() const { return constants_; }
  const Torque& torque() const { return torque_; }

  /// Fills rows 1 .. order of `coefficients` with y_k of y(t + theta sigma) = sum_k theta^k y_k,
  /// from the state y. The order is even, and at least `lowest_taylor_order`.
  template <class Number>
  PENDCORE_INLINE void expand(double t, const Number* y, double sigma, int order,
                              Number* coefficients) const;

 private:
  DoublePendulumConstants constants_;
  Torque torque_;
};

/// The series of a bare double pendulum; none for other equations.
std::optional<DoublePendulumSeries<NoTorque>> bare_series(const EquationsOfMotion& equations);
/// The series with couples and up to two waves of motors, while no joint is held and the pivot
/// stands still; none for other equations.
std::optional<DoublePendulumSeries<CoupleTorque<Pair>>> series_with_torque(
    const EquationsOfMotion& equations);

/// The numbers by which order k multiplies.
struct NumbersOfOrder {
  double inverse;           ///< 1/k
  double next;              ///< k + 1
  double second_over;       ///< (k + 2)/k
  double share;             ///< 1/(k + 1)
  double share_of_n;        ///< 1/((k + 1)(k + 2))
  double minus_share_of_n;  ///< so that no pack changes its sign
};
inline constexpr auto numbers_of_order = [] {
  std::array<NumbersOfOrder, highest_order + 1> table{};
  for (int k = 0; k < static_cast<int>(table.size()); ++k) {
    const double inverse = inverse_of[k];
    const double share = inverse_of[k + 1];
    const double of_n = share * inverse_of[k + 2];
    table[k] = {inverse, k + 1.0, (k + 2.0) * inverse, share, of_n, -of_n};
  }
  return table;
}();

/// a b + c for both links. A single run takes the loop over the lanes, which is faster here
/// (arithmetic/pack.hpp).
template <class Half>
PENDCORE_INLINE Half fma_of_links(const Half& a, const Half& b, const Half& c) {
#if !defined(__wasm__)
  if constexpr (std::is_same_v<Half, Pair>) return fma_lane_by_lane(a, b, c);
#endif
  return fma(a, b, c);
}

/// The orders of one series. Rows are (x, x', y, y'), along u_0 and n_0 of each link. In a single
/// run, a row for a rate is the pair twice.
template <class Number>
struct DoublePendulumOrders {
  using Constant = ConstantOf<Number>;
  using Of = SeriesOf<Number>;
  using Half = typename Of::Half;
  using Row = typename Of::Row;
  using Rate = typename Of::Rate;

  /// What an order leaves for the next. It stands apart from the arrays below: GCC keeps a
  /// structure with arrays in memory, and lanes took a twentieth more.
  struct Last {
    Half angle;  ///< q_k
    Half alpha;
    Half beta_x, beta_y;
    Half pull_x;
  };

  Constant per_sigma;
  Half minus_kappa;
  Half inverse;                   ///< 1/D
  Half pull_sine, pull_cosine;    ///< -rho S/D and -rho C/D
  Half minus_rate;                ///< -qd_0
  Rate rates[highest_order + 1];  ///< qd_k
  Row n[highest_order + 3];
  Row pulls[highest_order];  ///< in order 0 with the weight

  /// Computes order 0.
  template <class OfLinks, class TorqueOrders>
  PENDCORE_INLINE DoublePendulumOrders(const OfLinks& constants, const Number* y,
                                       const Constant& sigma, TorqueOrders& torque,
                                       Number* coefficients, Last& last);
  /// Computes order k >= 1 from its sums (terms_by_age.hpp).
  template <class TorqueOrders>
  PENDCORE_INLINE void next(std::ptrdiff_t k, const Row& along, const Row& across,
                            TorqueOrders& torque, Number* coefficients, Last& last);

 private:
  /// Computes what follows from alpha.
  PENDCORE_INLINE void finish(std::ptrdiff_t k, Number* coefficients, Last& last);
};

template <class Number>
template <class OfLinks, class TorqueOrders>
PENDCORE_INLINE DoublePendulumOrders<Number>::DoublePendulumOrders(
    const OfLinks& constants, const Number* y, const Constant& sigma, TorqueOrders& torque,
    Number* coefficients, Last& last) {
  auto& [angle, alpha, beta_x, beta_y, pull_x] = last;
  per_sigma = inverse_of_power_of_two(sigma);
  angle = Of::pair_at(y);
  Half s0, c0;
  sine_cosine(angle, s0, c0);
  const Half rate = sigma * Of::pair_at(y + 2);
  const Half sin = fma(s0, other(c0), -(c0 * other(s0)));
  const Half cos = fma(c0, other(c0), s0 * other(s0));
  const Half rest =
      fma(Constants<Half>::of(constants.epsilon), cos, Constants<Half>::of(constants.delta));
  inverse = 1.0 / fma(constants.product * sin, sin, rest);
  minus_kappa = fma(Half(-constants.coupling), cos, constants.rotor);
  const Half coupling = constants.coupling * inverse;
  pull_sine = coupling * sin;
  pull_cosine = -(coupling * cos);
  const Half weight = Constant(sigma * sigma) * constants.weight * inverse;
  const Half weight_x = weight * s0;
  const Half weight_y = weight * c0;
  rates[0] = Of::rate(rate);
  minus_rate = -rate;
  beta_x = minus_rate * rate;
  beta_y = Half{};
  Half f = fma(pull_sine, other(beta_x), weight_y);
  if constexpr (!std::is_same_v<TorqueOrders, NoTorque>) {
    f = fma(inverse, torque.next(0, angle, rate), f);
  }
  alpha = fma(minus_kappa, other(f), f);
  finish(0, coefficients, last);
  pull_x = pull_x + weight_x;
  pulls[0] = pulls[0] + joined(weight_x, weight_y);
}

template <class Number>
template <class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders<Number>::next(std::ptrdiff_t k, const Row& along,
                                                        const Row& across, TorqueOrders& torque,
                                                        Number* coefficients, Last& last) {
  auto& [angle, alpha, beta_x, beta_y, pull_x] = last;
  const NumbersOfOrder& of = numbers_of_order[k];
  const Half turn = of.inverse * minus_rate;
  const Half turn_of_alpha = of.second_over * minus_rate;
  const Half next = Constants<Half>::of(of.next);
  const Half turned_x = turn * beta_x;  // first: lanes would keep a copy of beta_x in memory
  beta_x = fma_of_links(turn_of_alpha, alpha, fma_of_links(next, low_half(along), turn * beta_y));
  beta_y = fma_of_links(next, high_half(along), -turned_x);
  const Half older = fma_of_links(pull_cosine, other(beta_y), high_half(across)) + low_half(across);
  Half f = fma_of_links(minus_rate, pull_x, fma_of_links(pull_sine, other(beta_x), older));
  if constexpr (!std::is_same_v<TorqueOrders, NoTorque>) {
    f = fma_of_links(inverse, torque.next(static_cast<int>(k), angle, Of::pair(rates[k])), f);
  }
  alpha = fma_of_links(minus_kappa, other(f), f);
  finish(k, coefficients, last);
}

template <class Number>
PENDCORE_INLINE void DoublePendulumOrders<Number>::finish(std::ptrdiff_t k, Number* coefficients,
                                                          Last& last) {
  auto& [angle, alpha, beta_x, beta_y, pull_x] = last;
  const NumbersOfOrder& of = numbers_of_order[k];
  const Half rate = of.share * alpha;
  angle = of.share * Of::pair(rates[k]);
  rates[k + 1] = Of::rate(rate);
  Of::put_row(coefficients + 4 * (k + 1), joined(angle, Half(per_sigma * rate)));
  const Half bend_y = beta_y + alpha;
  n[k + 2] = joined(Half(of.minus_share_of_n * bend_y), Half(of.share_of_n * beta_x));
  const Half x = other(beta_x);
  const Half y = other(bend_y);
  pull_x = fma_of_links(-pull_sine, y, pull_cosine * x);
  pulls[k] = joined(pull_x, fma_of_links(pull_cosine, y, pull_sine * x));
}

/// Calls `add` with a type of values and with functions that return pull_j, qd_j and n_j; it
/// returns TermsByAge of them. In lanes, the numbers of one link are added up after those of the
/// other: the sums of a whole row would not fit into the registers.
template <class Number, class Add>
PENDCORE_INLINE auto sums_of(const DoublePendulumOrders<Number>& orders, const Add& add) {
  using Row = typename SeriesOf<Number>::Row;
  if constexpr (Lanes<Number>::width == 1) {
    return add.template operator()<Row>(
        [&](std::ptrdiff_t j) __attribute__((always_inline)) { return orders.pulls[j]; },
        [&](std::ptrdiff_t j) __attribute__((always_inline)) { return orders.rates[j]; },
        [&](std::ptrdiff_t j) __attribute__((always_inline)) { return orders.n[j]; });
  } else {
    using AlongAxes = Two<Number>;  // a number along x, and one along y
    TermsByAge<Row> terms;
    const auto add_link = [&](Number Two<Number>::* link) __attribute__((always_inline)) {
      const auto of = [link](const Row& row) __attribute__((always_inline)) {
        return AlongAxes{row.first.*link, row.second.*link};
      };
      const auto put = [link](Row& row, const AlongAxes& x) __attribute__((always_inline)) {
        row.first.*link = x.first;
        row.second.*link = x.second;
      };
      const TermsByAge<AlongAxes> found = add.template operator()<AlongAxes>(
          [&](std::ptrdiff_t j) __attribute__((always_inline)) { return of(orders.pulls[j]); },
          [&](std::ptrdiff_t j) __attribute__((always_inline)) { return orders.rates[j].*link; },
          [&](std::ptrdiff_t j) __attribute__((always_inline)) { return of(orders.n[j]); });
      put(terms.along, found.along);
      put(terms.across, found.across);
      put(terms.next_along, found.next_along);
      put(terms.next_across, found.next_across);
    };
    add_link(&Two<Number>::first);
    add_link(&Two<Number>::second);
    return terms;
  }
}

/// Computes orders 1 .. order - 1.
template <class Number, class TorqueOrders>
PENDCORE_INLINE void complete(DoublePendulumOrders<Number>& orders, int order, TorqueOrders& torque,
                              Number* coefficients,
                              typename DoublePendulumOrders<Number>::Last& last) {
  using Row = typename DoublePendulumOrders<Number>::Row;
  const auto sums = [&](const auto& add)
                        __attribute__((always_inline)) { return sums_of(orders, add); };
  const auto next = [&](std::ptrdiff_t k, const Row& along, const Row& across)
                        __attribute__((always_inline)) {
                          orders.next(k, along, across, torque, coefficients, last);
                        };
  next(1, Row{}, Row{});
  expand_by_two<Row, (Lanes<Number>::width == 1)>(order, sums, next);
}

/// Fills rows 1 .. order of `coefficients` with the series from the state y, a row of four numbers,
/// in units of sigma. `constants` are ConstantsOfDoublePendulum of numbers or of their constants;
/// `torque` gives the series of the torques.
template <class Number, class OfLinks, class TorqueOrders>
PENDCORE_INLINE void expand_double_pendulum(const OfLinks& constants, const Number* y,
                                            const ConstantOf<Number>& sigma, int order,
                                            TorqueOrders& torque, Number* coefficients) {
  typename DoublePendulumOrders<Number>::Last last;
  DoublePendulumOrders<Number> orders(constants, y, sigma, torque, coefficients, last);
  complete(orders, order, torque, coefficients, last);
}

template <class Torque>
template <class Number>
PENDCORE_INLINE void DoublePendulumSeries<Torque>::expand(double t, const Number* y, double sigma,
                                                          int order, Number* coefficients) const {
  if constexpr (Torque::is_there) {
    const TorqueLaws<Pair, double> in_force = torque_laws(*torque_.effects, torque_.factor);
    TorqueOrders<typename SeriesOf<Number>::Half, double> orders(in_force, t, sigma);
    expand_double_pendulum(constants_, y, sigma, order, orders, coefficients);
  } else {
    NoTorque none;
    expand_double_pendulum(constants_, y, sigma, order, none, coefficients);
  }
}

}  // namespace pendcore
