/// \file
/// Steps by Taylor series of several trajectories at once.
///
/// As in a single run (integrate/taylor/taylor_step.hpp), a step ends with the series from its end,
/// which says how long the next step may be. A member that begins has no series yet: its first
/// round, in which it stays where it is, computes it.
#pragma once

#include <array>
#include <memory>
#include <utility>

#include "ensemble/lane_steps.hpp"
#include "ensemble/series_equations.hpp"
#include "integrate/taylor/taylor_step.hpp"

namespace pendcore {

/// Computes the series from y at time t in units of sigma. It is a kernel of its own, which a step
/// calls.
template <class Form, class Real>
PENDCORE_INLINE void expand_in_lanes(const Form* equations, const Real* t, const Real* y,
                                     const Real* sigma, int order, Real* rows) {
  equations->expand(*t, y, *sigma, order, rows);
}

/// It is compiled apart.
using ExpandBareSeriesOfFour =
    decltype(&expand_in_lanes<BareDoublePendulumSeries<Pack<4>>, Pack<4>>);
ExpandBareSeriesOfFour expand_bare_series_of_four();

/// The lanes of the method of Taylor series on a form of the equations (series_equations.hpp). A
/// state is (q, qd).
template <class Form, int width>
struct SeriesLanes : LaneSteps<width> {
  using Real = Pack<width>;
  using Integers = typename Lanes<Real>::Integers;
  using Equations = Form;
  /// Not std::vector: its allocator asks alignof, which GCC reports as on the baseline
  /// (effects/couples.hpp), while `new` has the true alignment.
  using Packs = std::unique_ptr<Real[]>;

  Equations equations;
  /// A clone of it.
  decltype(&expand_in_lanes<Form, Real>) expand_kernel = nullptr;
  Packs y, y_new, rtol, atol;
  Real sigma = {}, sigma_new = {};      ///< s, the unit of time of a series
  Real largest = {}, largest_new = {};  ///< s, the step that the tolerances allow
  Integers begins = {};                 ///< all bits set where a member has no series yet
  int order = lowest_taylor_order;
  double log2_count = 0.0;  ///< log2 of the count of numbers in a state
  Packs rows, rows_new;     ///< the series from y, and from y_new

  PENDCORE_INLINE int links() const {
    if constexpr (Equations::links != 0) {
      return Equations::links;
    } else {
      return equations.count();
    }
  }
  /// The numbers of a state.
  PENDCORE_INLINE int size() const { return 2 * links(); }

  /// Makes room for series of an order, once the equations are prepared.
  void make_room(int order_of_series) {
    order = order_of_series;
    for (Packs* const state : {&y, &y_new, &rtol, &atol}) {
      *state = std::make_unique<Real[]>(size());
    }
    for (Packs* const series : {&rows, &rows_new}) {
      *series = std::make_unique<Real[]>((order + 1) * size());
    }
    if constexpr (requires { equations.set_order(order); }) equations.set_order(order);
  }
};

namespace lanes_detail {

/// log2 of the step, in units of sigma, that the tolerances allow for the series from y.
template <class All, class Real>
PENDCORE_INLINE Real log2_of_step(const All* all, const Real* y, const Real* rows) {
  const int links = all->links();
  const int size = 2 * links;
  // A single run adds up the blocks of a state, and then the numbers of the sum: as here.
  constexpr int block = All::Equations::block;
  Real last[block]{}, before_last[block]{}, others[block]{}, before[block]{};
  const Real* const end = rows + static_cast<std::ptrdiff_t>(all->order) * size;
  const auto add_number = [&](int i, int at) __attribute__((always_inline)) {
    const Real moves = larger(absolute(rows[size + i]), absolute(rows[2 * size + i]));
    const Real most = larger(absolute(y[i]), moves);
    const Real scale = 1.0 / fma(all->rtol[i], most, all->atol[i]);
    const auto share = [&](int k) __attribute__((always_inline)) {
      return Real(scale * end[i - static_cast<std::ptrdiff_t>(k) * size]);
    };
    const auto add = [&](Real& sum, int first, int count) __attribute__((always_inline)) {
#pragma GCC unroll 4
      for (int k = first; k < first + count; ++k) sum = fma(share(k), share(k), sum);
    };
    add(last[at], 0, 1);
    add(before_last[at], 1, 1);
    add(others[at], 2, 2);
    add(before[at], 4, 4);
  };
  const auto add_links = [&](int begin, int place) __attribute__((always_inline)) {
    for (int i = 0; i < links; i += block) {
#pragma GCC unroll 4
      for (int k = 0; k < block; ++k) {
        if (i + k < links) add_number(begin + i + k, (place + k) % block);
      }
    }
  };
  add_links(0, 0);
  add_links(links, All::Equations::place_of_rates);
  // The order of the sums is that of sum_by_halves().
  const auto sum = [](const Real* x) __attribute__((always_inline)) {
    if constexpr (block == 2)
      return Real(x[0] + x[1]);
    else
      return Real((x[0] + x[2]) + (x[1] + x[3]));
  };
  Real all_high[block];
#pragma GCC unroll 4
  for (int i = 0; i < block; ++i) all_high[i] = last[i] + before_last[i] + others[i];
  const Real high = sum(all_high);
  const Real low = sum(before);
  const Real log2_high = coarse_log2(high);
  const Real decay = low == 0.0 ? Real{} : Real(0.25 * (coarse_log2(low) - log2_high));
  const Real log2_error =
      larger_or_first(larger_or_first(Real(log2_high - 3.0 * decay), coarse_log2(sum(last))),
                      Real(coarse_log2(sum(before_last)) - decay)) -
      all->log2_count;
  const Real log2_step = -0.5 * inverse_of[all->order] * log2_error;
  // Where no high power is left, or one is not finite, the lane goes on alone.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto is_usual = is_less(Real{}, high) & is_less(high, broadcast<Real>(infinity));
  return is_usual ? log2_step : broadcast<Real>(std::numeric_limits<double>::quiet_NaN());
}

/// Computes the series from y in units of sigma, which is chosen anew where it is far from the step
/// that the tolerances allow. Returns the lanes that have a usual series.
template <class All, class Real>
PENDCORE_INLINE typename All::Integers expand(All* all, const Real& t, const Real* y, Real* rows,
                                              Real& sigma, Real& largest) {
  using Integers = typename All::Integers;
  namespace detail = taylor_detail;
  Integers is_done{};
  for (int tries = 0; tries < detail::most_tries; ++tries) {
    all->expand_kernel(&all->equations, &t, y, &sigma, all->order, rows);
    const Real log2_step = log2_of_step(all, y, rows);
    is_done = is_at_most(absolute(log2_step), broadcast<Real>(detail::reach));
    largest = sigma * coarse_exp2(is_done ? log2_step : Real{});
    const LaneBits missing = ~bits_of(is_done) & all->active;
    if (missing == 0) break;
    const auto is_number = is_less(log2_step, Real{}) | is_less(Real{}, log2_step);
    const Real most = broadcast<Real>(detail::largest_shift);
    Real shift = is_number ? log2_step : broadcast<Real>(detail::usual_shift);
    shift = shift < -most ? Real(-most) : most < shift ? most : shift;
    const Real shifted = sigma * approximate_exp2(shift);
    const Real other_sigma = detail::power_of_two_below(shifted);
    sigma = is_done ? sigma : other_sigma;
  }
  return is_done;
}

/// sum_{k >= 1} x^k y_k for `count` neighbouring numbers of the state, in rows of `size`
/// (integrate/taylor/taylor_step.hpp).
template <int count, class Real>
PENDCORE_INLINE std::array<Real, count> increments(const Real* rows, std::ptrdiff_t size, int order,
                                                   const Real& x) {
  const Real square = x * x;
  const Real* row = rows + order * size;
  std::array<Real, count> even, odd;
  for (int i = 0; i < count; ++i) {
    even[i] = row[i];
    odd[i] = row[i - size];
  }
  for (int k = order - 2; k >= 2; k -= 2) {
    row -= 2 * size;
#pragma GCC unroll 4
    for (int i = 0; i < count; ++i) {
      even[i] = fma(square, even[i], row[i]);
      odd[i] = fma(square, odd[i], row[i - size]);
    }
  }
  for (int i = 0; i < count; ++i) even[i] = x * fma(x, even[i], odd[i]);
  return even;
}

}  // namespace lanes_detail

/// Takes up to `rounds` steps in each lane, until some need attention.
template <class Form, int width>
PENDCORE_INLINE Attention take_series_steps(SeriesLanes<Form, width>* all,
                                            const LaneInterval* interval, int rounds) {
  namespace detail = lanes_detail;
  using All = SeriesLanes<Form, width>;
  using Real = typename All::Real;
  using Integers = typename All::Integers;
  const int size = all->size();
  Attention attention;
  for (int round = 0; round < rounds && !attention.is_needed(); ++round) {
    const Integers begins = all->begins;
    const NextStep<width> next = next_step<width>(*all, *interval);
    Integers runs_alone = next.runs_alone & ~begins;
    const Real h = next.h;
    const Real x = h * inverse_of_power_of_two(all->sigma);
    constexpr int together = 2;  // whose sums fit into the registers
    for (int i = 0; i < size; i += together) {
      const auto moves = detail::increments<together>(all->rows.get() + i, size, all->order, x);
      for (int j = 0; j < together; ++j) {
        const Real after = all->y[i + j] + moves[j];
        all->y_new[i + j] = begins ? all->y[i + j] : after;
      }
    }
    const Real size_of_step = absolute(h);
    const Real share = size_of_step / all->largest;
    const Real square = share * share;
    const Real of_order = (square * square) * (square * square);
    const Real squared_error = of_order * of_order;
    // Rejections are rare here.
    runs_alone |= ~is_at_most(squared_error, broadcast<Real>(1.0)) & ~begins;

    const Real from_here =
        all->largest < taylor_detail::largest_sigma ? all->largest : size_of_step;
    all->sigma_new = begins ? all->sigma : taylor_detail::power_of_two_below(from_here);
    const TwoNumbers<Real> start{all->t, all->t_low};
    const Real t_new = begins ? all->t : (start + h).high;
    const Integers has_series = detail::expand(all, t_new, all->y_new.get(), all->rows_new.get(),
                                               all->sigma_new, all->largest_new);
    runs_alone |= ~has_series;
    const ErrorAndFactor<Real> found{squared_error,
                                     (taylor_detail::safety / size_of_step) * all->largest_new};

    const Integers tried = ~begins;
    const Integers is_looked_at = (all->steps_to_look == 0) & tried;
    all->steps_to_look = is_looked_at ? Integers{} + stiffness_looks_every : all->steps_to_look;
    finish_step<taylor, width>(*all, *interval, next, found, runs_alone, tried, attention);
    attention.looks = detail::bits_of(is_looked_at) & all->active & ~attention.runs_alone;
    if (attention.searched != 0) {
      const Integers may_happen =
          may_have_event(*all, all->y.get(), all->rows.get() + size, size, all->order, x);
      attention.recorded |= detail::bits_of(may_happen) & attention.searched;
      attention.searched = 0;
    }

    const Real max_step = broadcast<Real>(interval->max_step);
    const Real first = max_step < all->largest_new ? max_step : all->largest_new;
    all->h = begins ? (all->h < 0.0 ? Real(-first) : first) : all->h;
    all->begins = Integers{};
    std::swap(all->y, all->y_new);
    std::swap(all->rows, all->rows_new);
    std::swap(all->sigma, all->sigma_new);
    std::swap(all->largest, all->largest_new);
  }
  return attention;
}

}  // namespace pendcore
