/// \file
/// The equations of a chain of three or four links as recurrences of Taylor series.
///
/// Longer chains pass forces from link to link (chain_series.hpp), one link after the other in
/// every order. A few links fit into one pack, and their mass matrix is inverted once in a series,
/// so that an order costs a few operations on all links at once. With u_i and n_i along and across
/// link i, and A_ij and a_i of inertia.hpp, the equations are
///
///     A_ii qdd_i + n_i . H_i = tau_i,    H_i = sum_{j != i} A_ij u_j'' - g a_i e_y
///
/// As in double_pendulum_series.hpp, the newest unknown alpha = (k + 1) qd_{k+1} appears along n_0
/// alone: u''_k = alpha n_0 + beta. In units of sigma, with A without its diagonal, tau times
/// sigma^2, and w = sigma^2 g a e_y in order 0 and 0 in the others,
///
///     beta = (k + 1) sum_{j<=k} qd_j n_{k+1-j}
///     M_0 alpha = tau_k - n_0 . (A beta - w) - sum_{j<k} n_{k-j} . H_j
///     H_k = A beta - w + (A n_0) alpha
///
/// M_0 is the mass matrix at the angles q_0. Its inverse is U^T diag(r) U, the factors of the
/// recursion of chain.hpp: U takes the torques on all links to those that turn a link with the
/// links beyond it, and r is the inverse of what resists. Whatever the masses, nothing cancels in
/// r.
///
/// A product of a matrix and a row needs each number of the row beside each other one. `[d]` of a
/// matrix has its entries (i, i + d), counted around the end, and is multiplied by the row that is
/// shifted by d links.
///
/// Source: the recurrences are those of double_pendulum_series.hpp; the factors of the inverse are
/// those of Rodriguez, Jain and Kreutz-Delgado, Int. J. Robotics Research 10 (1991).
/// Cost: in a series a sine and cosine, a division and the factors of the inverse for each link;
/// for order k four sums of k products of rows, and some 40 operations on rows.
#pragma once

#include <cstddef>
#include <memory>

#include "arithmetic/order_of_series.hpp"
#include "arithmetic/power.hpp"
#include "arithmetic/row_of_links.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/chain/chain_link.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/series/known_terms.hpp"
#include "dynamics/series/torque_series.hpp"

namespace pendcore {

/// `Number` is a double, or a pack with one trajectory a lane.
template <class Number, int links>
struct ConstantsOfFewLinks {
  using Row = RowOfLinks<Number, links>;

  ChainLinkOf<Number> link[links];
  Number payload_mass;  ///< kg
  Row weight;           ///< g a_i
  Row coupling[links];  ///< [d] has A_{i,i+d}; [0] is not used

  template <class Any>
  static auto fields(Any& x) {
    return std::tie(x.link, x.payload_mass, x.weight, x.coupling);
  }
};

/// The constants of a chain without rotors between its links.
template <int links>
ConstantsOfFewLinks<double, links> constants_of_few_links(const Scene& scene);

/// A series of three or four links. A state is (q, qd), both padded to four numbers.
class FewLinksSeries {
 public:
  using Block = Pack<4>;
  using Effects = std::shared_ptr<const EffectsInRows<Pack<4>>>;
  static constexpr int blocks = 2;
  static constexpr bool is_short = false;
  static constexpr Sets sets = usual_sets;

  /// Whether this is the series of a scene whose effects all have one (without_series()): not if
  /// links are coupled by a rotor or may be held, if the pivot moves, or with more than two waves.
  static bool has(const Scene& scene, const EquationsOfMotion& equations);
  /// `effects` is null if none of them is in the equations of motion.
  FewLinksSeries(const Scene& scene, Effects effects);

  static constexpr int row() { return 4; }
  int links() const { return links_; }
  bool depends_on_time() const { return effects_ != nullptr; }
  void set_order(int /*order*/) {}

  /// Fills rows 1 .. order of `coefficients` with y_k of y(t + theta sigma) = sum_k theta^k y_k,
  /// from the state y. The order is even.
  template <class Number>
  PENDCORE_INLINE void expand(double t, const Number* y, double sigma, int order,
                              Number* coefficients) const;

 private:
  ConstantsOfFewLinks<double, 3> three_{};
  ConstantsOfFewLinks<double, 4> four_{};
  Effects effects_;
  int links_;
};

namespace few_links_detail {

/// Where rows are in a state of packs, of doubles, and of dual numbers.
template <class Number, int links>
struct Rows {
  static constexpr int numbers = links;
  PENDCORE_INLINE static RowOfLinks<Number, links> get(const Number* from) {
    RowOfLinks<Number, links> row;
    for (int i = 0; i < links; ++i) row.of[i] = from[i];
    return row;
  }
  PENDCORE_INLINE static void put(Number* to, const RowOfLinks<Number, links>& row) {
    for (int i = 0; i < links; ++i) to[i] = row.of[i];
  }
};
template <int links>
struct Rows<double, links> {
  static constexpr int numbers = 4;
  PENDCORE_INLINE static Pack<4> get(const double* from) { return load<Pack<4>>(from); }
  PENDCORE_INLINE static void put(double* to, const Pack<4>& row) { store(to, row); }
};
template <int links>
struct Rows<Dual<double>, links> {
  static constexpr int numbers = 4;
  PENDCORE_INLINE static Dual<Pack<4>> get(const Dual<double>* from) {
    return load<Dual<Pack<4>>>(from);
  }
  PENDCORE_INLINE static void put(Dual<double>* to, const Dual<Pack<4>>& row) { store(to, row); }
};

/// The factors of M_0^-1 = U^T diag(r) U. The entries of U on its diagonal are 1 and not kept.
template <class Row, int links>
struct InverseMassMatrix {
  Row r{};
  Row upper[links]{};       ///< U; [0] is not used
  Row transposed[links]{};  ///< U^T
};

template <class Number, int links, class Row>
PENDCORE_INLINE InverseMassMatrix<Row, links> inverse_mass_matrix(
    const ConstantsOfFewLinks<ConstantOf<Number>, links>& constants, const Row& sine,
    const Row& cosine) {
  struct Turning {
    Number r, wx, wy;  ///< r and w of chain.hpp; w along x and y
  };
  Turning turning[links];
  ForcePerAcceleration<Number> B{constants.payload_mass, Number{}, constants.payload_mass};
#pragma GCC unroll 4
  for (int i = links - 1; i >= 0; --i) {
    const ChainLinkOf<ConstantOf<Number>>& k = constants.link[i];
    const Number c = number_of(cosine, i);
    const Number s = number_of(sine, i);
    const Number wu = k.L * B.un;
    const Number wn = fma(k.L, B.nn, k.mc);
    const Number r = 1.0 / fma(k.LL, B.nn, k.Io);
    turning[i] = {r, fma(wu, c, Number(-(wn * s))), fma(wu, s, Number(wn * c))};
    if (i == 0) break;
    const Number c_before = number_of(cosine, i - 1);
    const Number s_before = number_of(sine, i - 1);
    const Number cos = fma(c, c_before, Number(s * s_before));
    const Number sin = fma(s, c_before, Number(-(c * s_before)));
    B.add_free(k, r, wu, cos * cos, sin * sin, sin * cos);
  }
  InverseMassMatrix<Row, links> inverse;
  // A torque on link j pushes the links before, through the forces in their joints: column j of U.
#pragma GCC unroll 4
  for (int j = 0; j < links; ++j) {
    set_number(inverse.r, j, turning[j].r);
    Number x = turning[j].wx * turning[j].r;
    Number y = turning[j].wy * turning[j].r;
#pragma GCC unroll 4
    for (int i = j - 1; i >= 0; --i) {
      const Number across = fma(number_of(cosine, i), y, Number(-(number_of(sine, i) * x)));
      const Number entry = -(constants.link[i].L * across);
      set_number(inverse.upper[j - i], i, entry);
      set_number(inverse.transposed[links + i - j], j, entry);
      const Number turned = turning[i].r * entry;
      x = fma(turning[i].wx, turned, x);
      y = fma(turning[i].wy, turned, y);
    }
  }
  return inverse;
}

/// The product of a matrix without its diagonal and a row.
template <int links, class Matrix, class Row>
PENDCORE_INLINE Row times(const Matrix* matrix, const Row& row) {
  Row sum = matrix[1] * link_after<links, 1>(row);
  if constexpr (links > 2) sum = fma(matrix[2], link_after<links, 2>(row), sum);
  if constexpr (links > 3) sum = fma(matrix[3], link_after<links, 3>(row), sum);
  return sum;
}

}  // namespace few_links_detail

/// The orders of one series.
template <class Number, int links>
struct FewLinksOrders {
  using Constant = ConstantOf<Number>;
  using Rows = few_links_detail::Rows<Number, links>;
  using Row = RowOfLinks<Number, links>;
  using Terms = KnownTerms<Two<Row>>;  // along x, and along y
  using Torques = TorqueOrders<Row, Constant>;

  const ConstantsOfFewLinks<Constant, links>& constants;
  Constant per_sigma;
  few_links_detail::InverseMassMatrix<Row, links> inverse;
  Row turned_x[links];  ///< A n_0; [0] is not used
  Row turned_y[links];
  Row angle_of_order;  ///< q_k
  Row nx[highest_order + 3], ny[highest_order + 3];
  Row rates[highest_order + 1];  ///< qd_k
  Row hx[highest_order + 1], hy[highest_order + 1];

  PENDCORE_INLINE FewLinksOrders(const ConstantsOfFewLinks<Constant, links>& given, const Number* y,
                                 const Constant& sigma)
      : constants(given), per_sigma(inverse_of_power_of_two(sigma)) {
    Row s, c;
    angle_of_order = Rows::get(y);
    sine_cosine(angle_of_order, s, c);
    rates[0] = sigma * Rows::get(y + Rows::numbers);
    nx[0] = -s;
    ny[0] = c;
    nx[1] = -(rates[0] * c);
    ny[1] = -(rates[0] * s);
    inverse = few_links_detail::inverse_mass_matrix<Number, links>(given, s, c);
    const auto turn = [&]<int by>() __attribute__((always_inline)) {
      if constexpr (by < links) {
        turned_x[by] = given.coupling[by] * link_after<links, by>(nx[0]);
        turned_y[by] = given.coupling[by] * link_after<links, by>(ny[0]);
      }
    };
    turn.template operator()<1>();
    turn.template operator()<2>();
    turn.template operator()<3>();
  }

  /// Computes order k from its sums. `pull` is sigma^2 g a in order 0, and null in the
  /// others.
  PENDCORE_INLINE_UNLESS_SMALL void finish(int k, const Row& along_x, const Row& along_y,
                                           const Row& across, const Row* pull, Torques& torques,
                                           Number* coefficients) {
    using few_links_detail::times;
    const double next = k + 1.0;
    const Row beta_x = next * along_x;
    const Row beta_y = next * along_y;
    Row push_x = times<links>(constants.coupling, beta_x);
    Row push_y = times<links>(constants.coupling, beta_y);
    if (pull != nullptr) push_y = push_y - *pull;
    Row load = -fma(nx[0], push_x, fma(ny[0], push_y, across));
    if (torques.are_any()) load = load + torques.next(k, angle_of_order, rates[k]);
    const Row free = inverse.r * (load + times<links>(inverse.upper, load));
    const Row alpha = free + times<links>(inverse.transposed, free);
    const double share = inverse_of[k + 1];
    angle_of_order = share * rates[k];
    const Row rate_after = share * alpha;
    rates[k + 1] = rate_after;
    const double share_after = share * inverse_of[k + 2];
    nx[k + 2] = -(share_after * fma(alpha, ny[0], beta_y));
    ny[k + 2] = share_after * fma(alpha, nx[0], beta_x);
    hx[k] = push_x + times<links>(turned_x, alpha);
    hy[k] = push_y + times<links>(turned_y, alpha);
    Number* const row = coefficients + static_cast<std::ptrdiff_t>(2 * Rows::numbers) * (k + 1);
    Rows::put(row, angle_of_order);
    Rows::put(row + Rows::numbers, per_sigma * rate_after);
  }

  /// Computes order k + 1 after order k, from the terms that were known before both.
  PENDCORE_INLINE void finish_next(int k, const Terms& known, Torques& torques,
                                   Number* coefficients) {
    const Two<Row>& along = known.next_along;
    const Row along_x = fma(rates[k + 1], nx[1], fma(rates[0], nx[k + 2], along.first));
    const Row along_y = fma(rates[k + 1], ny[1], fma(rates[0], ny[k + 2], along.second));
    const Row across =
        fma(hx[k], nx[1], known.next_across.first) + fma(hy[k], ny[1], known.next_across.second);
    finish(k + 1, along_x, along_y, across, nullptr, torques, coefficients);
  }

  /// Adds up the known terms of orders k >= 2 and k + 1. `of` takes a row to the numbers that are
  /// added up at a time.
  template <class Value, class Of>
  PENDCORE_INLINE KnownTerms<Two<Value>> known(int k, const Of& of) const {
    using AlongAxes = Two<Value>;
    return known_terms<AlongAxes>(
        k, [&](int j) __attribute__((always_inline)) { return AlongAxes{of(hx[j]), of(hy[j])}; },
        [&](int j) __attribute__((always_inline)) { return of(rates[j]); },
        [&](int j) __attribute__((always_inline)) { return AlongAxes{of(nx[j]), of(ny[j])}; });
  }
};

template <class Number, int links>
  requires(Lanes<Number>::width == 1)
PENDCORE_INLINE auto known_terms(const FewLinksOrders<Number, links>& orders, int k) {
  using Row = RowOfLinks<Number, links>;
  return orders.template known<Row>(
      k, [](const Row& row) __attribute__((always_inline)) { return row; });
}
/// In lanes, the links are added up one after the other: the sums of a whole row would not fit into
/// the registers.
template <class Real, int links>
  requires(Lanes<Real>::width > 1)
PENDCORE_INLINE KnownTerms<Two<EachLink<Real, links>>> known_terms(
    const FewLinksOrders<Real, links>& orders, int k) {
  using Row = EachLink<Real, links>;
  KnownTerms<Two<Row>> terms;
#pragma GCC unroll 4
  for (int i = 0; i < links; ++i) {
    const KnownTerms<Two<Real>> found = orders.template known<Real>(
        k, [i](const Row& row) __attribute__((always_inline)) { return row.of[i]; });
    const auto put = [i](Two<Row>& to, const Two<Real>& x) __attribute__((always_inline)) {
      to.first.of[i] = x.first;
      to.second.of[i] = x.second;
    };
    put(terms.along, found.along);
    put(terms.across, found.across);
    put(terms.next_along, found.next_along);
    put(terms.next_across, found.next_across);
  }
  return terms;
}

/// Fills rows 1 .. order of `coefficients` with the series from the state y in units of sigma.
template <class Number, int links>
PENDCORE_INLINE void expand_few_links(
    const ConstantsOfFewLinks<ConstantOf<Number>, links>& constants,
    const TorqueLaws<RowOfLinks<ConstantOf<Number>, links>, ConstantOf<Number>>& laws,
    const ConstantOf<Number>& t, const Number* y, const ConstantOf<Number>& sigma, int order,
    Number* coefficients) {
  using Orders = FewLinksOrders<Number, links>;
  using Row = typename Orders::Row;
  typename Orders::Torques torques(laws, t, sigma);
  Orders orders(constants, y, sigma);
  const Row pull = ConstantOf<Number>(sigma * sigma) * constants.weight;
  orders.finish(0, orders.rates[0] * orders.nx[1], orders.rates[0] * orders.ny[1], Row{}, &pull,
                torques, coefficients);
  orders.finish_next(0, typename Orders::Terms{}, torques, coefficients);
  for (int k = 2; k < order; k += 2) {
    const typename Orders::Terms known = known_terms(orders, k);
    orders.finish(k, known.along.first, known.along.second,
                  known.across.first + known.across.second, nullptr, torques, coefficients);
    orders.finish_next(k, known, torques, coefficients);
  }
}

template <class Number>
PENDCORE_INLINE void FewLinksSeries::expand(double t, const Number* y, double sigma, int order,
                                            Number* coefficients) const {
  TorqueLaws<Pack<4>, double> laws;
  if (effects_) laws = torque_laws(*effects_, broadcast<Pack<4>>(1.0));
  if (links_ == 3) {
    expand_few_links<Number, 3>(three_, laws, t, y, sigma, order, coefficients);
  } else {
    expand_few_links<Number, 4>(four_, laws, t, y, sigma, order, coefficients);
  }
}

}  // namespace pendcore
