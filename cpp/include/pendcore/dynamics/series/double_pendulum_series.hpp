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
/// The weight is a pull like that of the other link: gamma c_k is n_k times (0, gamma), which is
/// added to -rho u''_0(other).
///
/// Source: the recurrences of automatic differentiation (Moore, Interval Analysis, 1966, chapter
/// 11; Jorba and Zou, Exp. Math. 14, 2005); the elimination is this project's.
/// Cost: a sine and cosine of a pair, a division, and for order p some p^2/2 pairs of products.
#pragma once

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

#include "pendcore/arithmetic/order_of_series.hpp"
#include "pendcore/arithmetic/pair.hpp"
#include "pendcore/arithmetic/power.hpp"
#include "pendcore/arithmetic/row_of_pairs.hpp"
#include "pendcore/arithmetic/sine_cosine.hpp"
#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/series/known_terms.hpp"
#include "pendcore/dynamics/series/torque_series.hpp"

namespace pendcore {

/// What a series is made of: numbers, pairs of them, and rows of two pairs. `Number` is a double, a
/// dual number, or a pack with one trajectory a lane.
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

template <>
struct SeriesOf<Dual<double>> {
  using Half = Dual<Pair>;
  using Row = Dual<Pairs>;
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

  const DoublePendulumConstants& constants() const { return constants_; }
  /// The laws of its torques that are in force now.
  PENDCORE_INLINE TorqueLaws<Pair, double> laws() const
    requires(Torque::is_there)
  {
    return torque_laws(*torque_.effects, torque_.factor);
  }

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

/// The orders of one series. Rows are (c, c', s, s'); for rates and other numbers without a
/// direction, a row is the pair twice.
template <class Number>
struct DoublePendulumOrders {
  using Constant = ConstantOf<Number>;
  using Of = SeriesOf<Number>;
  using Half = typename Of::Half;
  using Row = typename Of::Row;
  using Terms = KnownTerms<Row>;

  Constant per_sigma;
  Half own, cross;  ///< 1/D and -kappa/D of the two by two system
  Row minus_rho;
  Row across_by_rho;              ///< -rho n_0
  Row weight;                     ///< sigma^2 gamma, along y
  Half angle_of_order;            ///< q_k
  Half rates[highest_order + 1];  ///< qd_k
  Row n[highest_order + 3];
  Row pulls[highest_order];  ///< -rho u''(other); in order 0 with the weight

  PENDCORE_INLINE DoublePendulumOrders(const ConstantsOfDoublePendulum<Constant>& constants,
                                       const Number* y, const Constant& sigma);

  /// Computes order k from its sums.
  template <class TorqueOrders>
  PENDCORE_INLINE void finish(int k, const Row& along, const Row& across, TorqueOrders& torque,
                              Number* coefficients);
  /// Computes order k + 1 after order k, from the terms that were known before both.
  template <class TorqueOrders>
  PENDCORE_INLINE void finish_next(int k, const Terms& known, TorqueOrders& torque,
                                   Number* coefficients) {
    const Row older = fma(twice(rates[0]), n[k + 2], known.next_along);
    const Row along = fma(twice(rates[k + 1]), n[1], older);
    finish(k + 1, along, fma(pulls[k], n[1], known.next_across), torque, coefficients);
  }
};

template <class Number>
PENDCORE_INLINE DoublePendulumOrders<Number>::DoublePendulumOrders(
    const ConstantsOfDoublePendulum<Constant>& constants, const Number* y, const Constant& sigma) {
  per_sigma = inverse_of_power_of_two(sigma);
  Half s0, c0;
  sine_cosine(Of::pair_at(y), s0, c0);
  angle_of_order = Of::pair_at(y);
  rates[0] = sigma * Of::pair_at(y + 2);
  const Half sine = fma(s0, other(c0), -(c0 * other(s0)));
  const Half cosine = fma(c0, other(c0), s0 * other(s0));
  const Half rest =
      fma(Constants<Half>::of(constants.epsilon), cosine, Constants<Half>::of(constants.delta));
  own = 1.0 / fma(constants.product * sine, sine, rest);
  cross = fma(Half(-constants.coupling), cosine, constants.rotor) * own;
  minus_rho = twice(-constants.coupling);
  weight = joined(Half{}, Half(sigma * sigma * constants.weight));
  n[0] = turned(joined(c0, s0));
  n[1] = turned(Row(twice(rates[0]) * n[0]));
  across_by_rho = minus_rho * n[0];
}

template <class Number>
template <class TorqueOrders>
PENDCORE_INLINE void DoublePendulumOrders<Number>::finish(int k, const Row& along,
                                                          const Row& across, TorqueOrders& torque,
                                                          Number* coefficients) {
  const Row beta = (k + 1.0) * along;
  Half f = low_half(halves_added(fma(across_by_rho, other(beta), across)));
  if constexpr (!std::is_same_v<TorqueOrders, NoTorque>) {
    f = f + torque.next(k, angle_of_order, rates[k]);
  }
  const Half alpha = fma(cross, other(f), own * f);
  const double share = inverse_of[k + 1];
  angle_of_order = share * rates[k];
  rates[k + 1] = share * alpha;
  Of::put_row(coefficients + static_cast<std::ptrdiff_t>(4) * (k + 1),
              joined(angle_of_order, Half(per_sigma * rates[k + 1])));
  const Row bend = fma(twice(alpha), n[0], beta);  // u''
  n[k + 2] = turned(Row((share * inverse_of[k + 2]) * bend));
  pulls[k] = minus_rho * other(bend);
}

template <class Number>
  requires(Lanes<Number>::width == 1)
PENDCORE_INLINE auto known_terms(const DoublePendulumOrders<Number>& orders, int k) {
  return known_terms<typename SeriesOf<Number>::Row>(
      k, [&](int j) __attribute__((always_inline)) { return orders.pulls[j]; },
      [&](int j) __attribute__((always_inline)) { return twice(orders.rates[j]); },
      [&](int j) __attribute__((always_inline)) { return orders.n[j]; });
}
/// In lanes, the numbers of one link are added up after those of the other: the sums of a whole row
/// would not fit into the registers.
template <class Real>
  requires(Lanes<Real>::width > 1)
PENDCORE_INLINE KnownTerms<TwoPairs<Real>> known_terms(const DoublePendulumOrders<Real>& orders,
                                                       int k) {
  using AlongAxes = Two<Real>;  // a number along x, and one along y
  KnownTerms<TwoPairs<Real>> terms;
  const auto add = [&](Real Two<Real>::* link) __attribute__((always_inline)) {
    const auto of = [link](const TwoPairs<Real>& row) __attribute__((always_inline)) {
      return AlongAxes{row.first.*link, row.second.*link};
    };
    const auto put = [link](TwoPairs<Real>& row, const AlongAxes& x)
                         __attribute__((always_inline)) {
                           row.first.*link = x.first;
                           row.second.*link = x.second;
                         };
    const KnownTerms<AlongAxes> found = known_terms<AlongAxes>(
        k, [&](int j) __attribute__((always_inline)) { return of(orders.pulls[j]); },
        [&](int j) __attribute__((always_inline)) { return orders.rates[j].*link; },
        [&](int j) __attribute__((always_inline)) { return of(orders.n[j]); });
    put(terms.along, found.along);
    put(terms.across, found.across);
    put(terms.next_along, found.next_along);
    put(terms.next_across, found.next_across);
  };
  add(&Two<Real>::first);
  add(&Two<Real>::second);
  return terms;
}

/// Fills rows 1 .. order of `coefficients` with the series from the state y, a row of four numbers,
/// in units of sigma. `torque` gives the series of the torques.
template <class Number, class TorqueOrders>
PENDCORE_INLINE void expand_double_pendulum(
    const ConstantsOfDoublePendulum<ConstantOf<Number>>& constants, const Number* y,
    const ConstantOf<Number>& sigma, int order, TorqueOrders& torque, Number* coefficients) {
  using Orders = DoublePendulumOrders<Number>;
  Orders orders(constants, y, sigma);
  orders.finish(0, twice(orders.rates[0]) * orders.n[1], orders.weight * orders.n[0], torque,
                coefficients);
  orders.pulls[0] = orders.pulls[0] + orders.weight;
  orders.finish_next(0, typename Orders::Terms{}, torque, coefficients);
  for (int k = 2; k < order; k += 2) {
    const typename Orders::Terms known = known_terms(orders, k);
    orders.finish(k, known.along, known.across, torque, coefficients);
    orders.finish_next(k, known, torque, coefficients);
  }
}

template <class Torque>
template <class Number>
PENDCORE_INLINE void DoublePendulumSeries<Torque>::expand(double t, const Number* y, double sigma,
                                                          int order, Number* coefficients) const {
  if constexpr (Torque::is_there) {
    const TorqueLaws<Pair, double> in_force = laws();
    TorqueOrders<typename SeriesOf<Number>::Half, double> orders(in_force, t, sigma);
    expand_double_pendulum(constants_, y, sigma, order, orders, coefficients);
  } else {
    NoTorque none;
    expand_double_pendulum(constants_, y, sigma, order, none, coefficients);
  }
}

}  // namespace pendcore
