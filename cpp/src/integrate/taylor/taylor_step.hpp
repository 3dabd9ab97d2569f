/// \file
/// One step of the method of Taylor series (taylor.hpp): the kernels.
///
/// A system is a `Series`. It has the size of its rows, `links()` and `row()`; whether it
/// `depends_on_time()`; what a processor works on, `Block` and `blocks` (0 if known only at run
/// time); and
///
///     expand(t, y, sigma, order, coefficients)
///
/// expand() fills rows 1 .. order with y_k, y(t + theta sigma) = sum_k theta^k y_k. Sigma is a
/// power of two: its inverse is taken by its exponent. The step knows nothing of pendulums.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "arithmetic/order_of_series.hpp"
#include "arithmetic/pack.hpp"
#include "arithmetic/power.hpp"
#include "arithmetic/two_double.hpp"
#include "integrate/horner.hpp"
#include "integrate/loop/attempt.hpp"
#include "integrate/taylor/taylor.hpp"

namespace pendcore {

/// The data of one step: rows of `blocks` blocks, a row for each power.
template <class Series>
struct TaylorMemory {
  Series series;
  int order = lowest_taylor_order;
  int blocks = 1;
  double log2_count = 0.0;  ///< log2 of the count of numbers in a state
  double *y = nullptr, *y_new = nullptr, *rtol = nullptr, *atol = nullptr;
  double *low = nullptr, *low_new = nullptr;    ///< rounding errors of y and y_new, if compensated
  double *rows = nullptr, *rows_new = nullptr;  ///< the series from y and y_new: order + 1 rows
  double sigma = 1.0, sigma_new = 1.0;
  double largest = 1.0, largest_new = 1.0;  ///< the step that the tolerances allow, s
};

namespace taylor_detail {

/// Sigma is chosen anew where the step that tolerances allow is not within 2^+-reach of it.
inline constexpr double reach = 8.0;
inline constexpr int most_tries = 12;
inline constexpr double largest_shift = 60.0;  ///< of log2 of sigma, in one try
inline constexpr double usual_shift = -20.0;   ///< where the series does not say how far
inline constexpr double largest_sigma = 0x1p400;
/// A step aims at this share of the longest one, as a last step may be a hundredth longer.
inline constexpr double safety = 0.95;

/// The power 2^k <= x < 2^(k+1), within limits that leave room for its powers.
template <class Real>
PENDCORE_INLINE Real power_of_two_below(const Real& x) {
  const Real least = broadcast<Real>(1.0 / largest_sigma);
  const Real most = broadcast<Real>(largest_sigma);
  const Real above = x < least ? least : x;
  const Real within = most < above ? most : above;
  using Integers = typename Lanes<Real>::Integers;
  return std::bit_cast<Real>(std::bit_cast<Integers>(within) & 0x7ff0000000000000);
}

/// The squared rate of a motion, 1/s^2, from the derivatives of n angles and n rates.
inline double squared_rate(const double* dydt, int n) {
  double rate = 0.0;
  for (int i = 0; i < n; ++i) rate = std::max({rate, dydt[i] * dydt[i], std::abs(dydt[n + i])});
  return rate;
}
/// The unit of time with which a run begins, s.
inline double first_sigma(double squared_rate) {
  return power_of_two_below(squared_rate > 0.0 ? 1.0 / std::sqrt(squared_rate) : 1.0);
}

/// The powers of a smaller number are finite at every order; a usual step has no larger one.
inline constexpr int exponent_of_no_large_powers = 8;
inline constexpr double no_large_powers = 1 << exponent_of_no_large_powers;
static_assert(exponent_of_no_large_powers * highest_order <
              std::numeric_limits<double>::max_exponent);

template <class Series>
PENDCORE_INLINE int blocks_of(const TaylorMemory<Series>* memory) {
  if constexpr (Series::blocks > 0) {
    return Series::blocks;
  } else {
    return memory->blocks;
  }
}

/// sum_{k >= 1} x^k y_k for one block, with even and odd powers summed side by side. The order is
/// even.
template <class Block>
PENDCORE_INLINE Block increment(const double* rows, int size, int order, double x) {
  const double square = x * x;
  const double* row = rows + static_cast<std::ptrdiff_t>(order) * size;
  Block even = load<Block>(row);
  Block odd = load<Block>(row - size);
  for (int k = order - 2; k >= 2; k -= 2) {
    row -= 2 * static_cast<std::ptrdiff_t>(size);
    even = fma(broadcast<Block>(square), even, load<Block>(row));
    odd = fma(broadcast<Block>(square), odd, load<Block>(row - size));
  }
  return x * fma(broadcast<Block>(x), even, odd);
}

/// log2 of the step, in units of sigma, that the tolerances allow for the series from y; NaN if it
/// is not finite, infinite if it has no high powers.
template <class Series>
PENDCORE_INLINE double log2_of_step(const TaylorMemory<Series>* memory, const double* y,
                                    const double* rows) {
  using Block = typename Series::Block;
  constexpr int width = Lanes<Block>::width;
  const int blocks = blocks_of(memory);
  const int size = blocks * width;
  const double* const end = rows + static_cast<std::ptrdiff_t>(memory->order) * size;
  Block last{}, before_last{}, others{}, before{};
  for (int i = 0; i < blocks; ++i) {
    const int at = i * width;
    const Block moves =
        larger(absolute(load<Block>(rows + size + at)),
               absolute(load<Block>(rows + 2 * static_cast<std::ptrdiff_t>(size) + at)));
    const Block largest = larger(absolute(load<Block>(y + at)), moves);
    const Block scale =
        1.0 / fma(load<Block>(memory->rtol + at), largest, load<Block>(memory->atol + at));
    auto add = [&](Block& sum, int k) __attribute__((always_inline)) {
      const Block share = scale * load<Block>(end - static_cast<std::ptrdiff_t>(k) * size + at);
      sum = fma(share, share, sum);
    };
    add(last, 0);
    add(before_last, 1);
    add(others, 2);
    add(others, 3);
    add(before, 4);
    add(before, 5);
    add(before, 6);
    add(before, 7);
  }
  const double of_last = sum_by_halves(last);
  const double of_before_last = sum_by_halves(before_last);
  const double high = sum_by_halves(Block(last + before_last + others));
  const double low = sum_by_halves(before);
  if (high == 0.0) return std::numeric_limits<double>::infinity();
  if (!(high < std::numeric_limits<double>::infinity())) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double log2_high = coarse_log2(high);
  const double decay = low == 0.0 ? 0.0 : 0.25 * (coarse_log2(low) - log2_high);  // 2 log2 r
  const double log2_error = std::max({log2_high - 3.0 * decay, coarse_log2(of_last),
                                      coarse_log2(of_before_last) - decay}) -
                            memory->log2_count;
  return -0.5 * inverse_of[memory->order] * log2_error;
}

/// Computes the series from y at time t in units of `sigma`. `largest` becomes the step that the
/// tolerances allow, and sigma is chosen anew if it is far from this step. Returns false if the
/// series is not finite.
template <class Series>
PENDCORE_INLINE bool expand(TaylorMemory<Series>* memory, double t, const double* y, double* rows,
                            double& sigma, double& largest) {
  for (int tries = 0; tries < most_tries; ++tries) {
    memory->series.expand(t, y, sigma, memory->order, rows);
    const double log2_step = log2_of_step(memory, y, rows);
    if (std::abs(log2_step) <= reach) [[likely]] {
      largest = sigma * coarse_exp2(log2_step);
      return true;
    }
    if (log2_step == std::numeric_limits<double>::infinity()) {
      largest = log2_step;
      return true;
    }
    const double shift = log2_step < 0.0 || log2_step > 0.0 ? log2_step : usual_shift;
    const double clamped = std::clamp(shift, -largest_shift, largest_shift);
    sigma = power_of_two_below(sigma * approximate_exp2(clamped));
  }
  return false;
}

}  // namespace taylor_detail

/// Computes y_new, the series at the end of a step of size h.
template <class Series, bool compensated>
PENDCORE_INLINE void advance_series(TaylorMemory<Series>* memory, double h) {
  namespace detail = taylor_detail;
  using Block = typename Series::Block;
  constexpr int width = Lanes<Block>::width;
  const int size = detail::blocks_of(memory) * width;
  const double x = h * inverse_of_power_of_two(memory->sigma);
  for (int at = 0; at < size; at += width) {
    const Block before = load<Block>(memory->y + at);
    const Block change = detail::increment<Block>(memory->rows + at, size, memory->order, x);
    if constexpr (compensated) {
      const Block whole = change + load<Block>(memory->low + at);
      const Block after = before + whole;
      store(memory->y_new + at, after);
      store(memory->low_new + at, left_over(before, whole, after));
    } else {
      store(memory->y_new + at, Block(before + change));
    }
  }
}

/// Takes the step of size h to t_new by `advance`, and computes the series from there by `expand`.
template <class Series, class Advance, class Expand>
PENDCORE_INLINE Attempt attempt_series(TaylorMemory<Series>* memory, double t_new, double h,
                                       const Advance& advance, const Expand& expand) {
  namespace detail = taylor_detail;
  advance(memory, h);
  const double size_of_step = std::abs(h);
  // The error is reported as of order 8, for what the control makes of a step that is too long.
  const double share = size_of_step / memory->largest;
  const double square = share * share;
  const double of_order = (square * square) * (square * square);
  const double squared_error = of_order * of_order;

  const double from_here = memory->largest < detail::largest_sigma ? memory->largest : size_of_step;
  memory->sigma_new = detail::power_of_two_below(from_here);
  if (!expand(memory, t_new, memory->y_new, memory->rows_new, memory->sigma_new,
              memory->largest_new)) {
    return {{std::numeric_limits<double>::quiet_NaN(), 0.0}};
  }
  return {{squared_error, (detail::safety / size_of_step) * memory->largest_new}};
}

/// The same in one kernel, which is a twentieth faster where the series is short. Longer series are
/// compiled once, as a kernel of their own.
template <class Series, bool compensated>
PENDCORE_INLINE Attempt attempt_short_series(TaylorMemory<Series>* memory, double t_new, double h) {
  auto advance = [](TaylorMemory<Series>* all, double step) __attribute__((always_inline)) {
    advance_series<Series, compensated>(all, step);
  };
  auto expand = [](TaylorMemory<Series>* all, double time, const double* y, double* rows,
                   double& sigma, double& largest) __attribute__((always_inline)) {
    return taylor_detail::expand(all, time, y, rows, sigma, largest);
  };
  return attempt_series(memory, t_new, h, advance, expand);
}

/// y + sum_k theta^k y_k at theta = (time - start)/h, on rows of `dimension` numbers.
PENDCORE_INLINE void sample_series(const double* coefficients, TwoDouble start, double h,
                                   const double* times, int count, double* states, int dimension,
                                   int order) {
  for (int k = 0; k < count; ++k) {
    const double theta = theta_at(times[k], start, h);
    double* const state = states + static_cast<std::ptrdiff_t>(k) * dimension;
    auto value = [&]<class Block>(int at) __attribute__((always_inline)) {
      const Block change =
          taylor_detail::increment<Block>(coefficients + at, dimension, order, theta);
      store(state + at, Block(load<Block>(coefficients + at) + change));
    };
    int at = 0;
    for (; at + 4 <= dimension; at += 4) value.template operator()<Pack<4>>(at);
    for (; at < dimension; ++at) value.template operator()<double>(at);
  }
}

/// Writes rows x^k y_k, k >= 1, of the series from y, in rows of `dimension` numbers: n angles, n
/// rates.
template <class Series>
PENDCORE_INLINE void powers_of_step(const TaylorMemory<Series>* memory, double x, int n, int row,
                                    int dimension, double* coefficients) {
  using Block = typename Series::Block;
  const int size = 2 * row;
  double power = 1.0;
  for (int k = 1; k <= memory->order; ++k) {
    const double* const from = memory->rows + static_cast<std::ptrdiff_t>(k) * size;
    double* const to = coefficients + static_cast<std::ptrdiff_t>(k) * dimension;
    power *= x;
    if constexpr (Series::blocks == 1) {  // a row of the series has no padding
      store(to, Block(power * load<Block>(from)));
    } else if (row == n) {
      for (int at = 0; at < size; at += Lanes<Block>::width) {
        store(to + at, Block(power * load<Block>(from + at)));
      }
    } else {
      for (int i = 0; i < n; ++i) {
        to[i] = power * from[i];
        to[n + i] = power * from[row + i];
      }
    }
  }
}

}  // namespace pendcore
