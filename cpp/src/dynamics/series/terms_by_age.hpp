/// \file
/// The sums of products in the orders of the series of two links (double_pendulum_series.hpp),
/// with their terms in the order in which they become known.
///
///     along_k  = sum_{0 < j < k}   qd_j n_{k+1-j}
///     across_k = sum_{j <= k-2}    pull_j . n_{k-j}
///
/// The terms with qd_0 and n_1 are left to the caller: they wait for the order before. Two orders,
/// k and k + 1, are computed at a time, so that what their sums share is loaded once.
///
/// What bounds an order of a single run is how long it waits for the orders before it. The sums do
/// not have to wait with it: of orders k + 2 and k + 3, all terms but those that orders k and k + 1
/// give are added up before these two, from the oldest in the middle of a sum to the newest at both
/// ends. The processor does so while it waits. Added from one end, the terms took a tenth more of a
/// step. Trajectories in lanes are bound by the number of operations and of numbers that move
/// between memory and registers: their sums are completed while they are in registers.
#pragma once

#include <cstddef>

#include "arithmetic/pair.hpp"

namespace pendcore {

/// The sums of orders k and k + 1, or a part of them.
template <class Value>
struct TermsByAge {
  Value along = Constants<Value>::of(0.0), across = along, next_along = along, next_across = along;

  TermsByAge() = default;
  // GCC would copy the structure in parts of 64 bytes, whose loads wait until the packs that were
  // stored before are in memory: a fifth of a step.
  PENDCORE_INLINE TermsByAge(const TermsByAge& x)
      : along(x.along),  // NOLINT(*-use-equals-default)
        across(x.across),
        next_along(x.next_along),
        next_across(x.next_across) {}
  PENDCORE_INLINE TermsByAge& operator=(const TermsByAge& x) {  // NOLINT(*-use-equals-default)
    along = x.along;
    across = x.across;
    next_along = x.next_along;
    next_across = x.next_across;
    return *this;
  }
  ~TermsByAge() = default;
};

/// The sums of orders 2 and 3, of the numbers that `pull(j)`, `rate(j)` and `n(j)` return.
template <class Value, class Pull, class Rate, class Normal>
PENDCORE_INLINE TermsByAge<Value> first_terms(const Pull& pull, const Rate& rate, const Normal& n) {
  const Value none = Constants<Value>::of(0.0);
  TermsByAge<Value> sum;
  sum.along = fma(rate(1), n(2), none);
  sum.across = fma(pull(0), n(2), none);
  sum.next_along = fma(rate(1), n(3), fma(rate(2), n(2), none));
  sum.next_across = fma(pull(0), n(3), fma(pull(1), n(2), none));
  return sum;
}

/// Adds up the terms of orders k >= 4 and k + 1, k even, that are known before orders k - 2 and
/// k - 1.
template <class Value, class Pull, class Rate, class Normal>
PENDCORE_INLINE TermsByAge<Value> older_terms(std::ptrdiff_t k, const Pull& pull, const Rate& rate,
                                              const Normal& n) {
  TermsByAge<Value> sum;
  std::ptrdiff_t above = k / 2;
  std::ptrdiff_t below = above;
  auto low_rate = rate(below);
  auto low_pull = pull(below - 1);
  auto high_rate = low_rate;
  auto high_pull = low_pull;
  for (; below > 2; ++above, --below) {
    const auto high_n = n(above + 2);
    sum.next_along = fma(low_rate, high_n, sum.next_along);
    sum.next_across = fma(low_pull, high_n, sum.next_across);
    low_rate = rate(below - 1);
    low_pull = pull(below - 2);
    sum.along = fma(low_rate, high_n, sum.along);
    sum.across = fma(low_pull, high_n, sum.across);
    const auto low_n = n(below + 1);
    sum.along = fma(high_rate, low_n, sum.along);
    sum.across = fma(high_pull, low_n, sum.across);
    high_rate = rate(above + 1);
    high_pull = pull(above);
    sum.next_along = fma(high_rate, low_n, sum.next_along);
    sum.next_across = fma(high_pull, low_n, sum.next_across);
  }
  const auto n_3 = n(3);
  sum.along = fma(high_rate, n_3, sum.along);
  sum.across = fma(high_pull, n_3, sum.across);
  return sum;
}

/// Adds the terms that orders k - 2 and k - 1 gave, each of them with one of the oldest numbers.
/// `first` is 1, the order of the oldest rate: see unknown_one().
template <class Value, class Pull, class Rate, class Normal>
PENDCORE_INLINE TermsByAge<Value> with_newest_terms(const TermsByAge<Value>& older,
                                                    std::ptrdiff_t k, std::ptrdiff_t first,
                                                    const Pull& pull, const Rate& rate,
                                                    const Normal& n) {
  const std::ptrdiff_t second = first + 1;
  const std::ptrdiff_t third = first + 2;
  TermsByAge<Value> sum;
  sum.along = fma(rate(first), n(k), fma(rate(k - 1), n(second), older.along));
  sum.across = fma(pull(first - 1), n(k), fma(pull(k - 2), n(second), older.across));
  const Value along = fma(rate(second), n(k), fma(rate(k - 1), n(third), older.next_along));
  const Value across = fma(pull(first), n(k), fma(pull(k - 2), n(third), older.next_across));
  sum.next_along = fma(rate(first), n(k + 1), fma(rate(k), n(second), along));
  sum.next_across = fma(pull(first - 1), n(k + 1), fma(pull(k - 1), n(second), across));
  return sum;
}

/// Returns 1 so that the compiler does not know it. If it did, GCC would load the oldest numbers
/// ahead of the loops of older_terms(), and store them again for lack of registers: a ninth of a
/// series in lanes on processors that store 32 bytes at a time (Zen 4).
PENDCORE_INLINE std::ptrdiff_t unknown_one() {
  std::ptrdiff_t one = 1;
  asm volatile("" : "+r"(one));
  return one;
}

/// Computes orders 2 .. order - 1, `order` even. `sums_of(add)` calls one of the functions above
/// with functions of its series, and `next(k, along, across)` computes order k from its sums.
template <class Row, bool is_single, class SumsOf, class Next>
PENDCORE_INLINE void expand_by_two(int order, const SumsOf& sums_of, const Next& next) {
  const auto two_orders = [&](std::ptrdiff_t k, const TermsByAge<Row>& sums)
                              __attribute__((always_inline)) {
                                next(k, sums.along, sums.across);
                                next(k + 1, sums.next_along, sums.next_across);
                              };
  const auto older = [&](std::ptrdiff_t k) __attribute__((always_inline)) {
    return sums_of(
        [k]<class Value>(const auto& pull, const auto& rate, const auto& n)
            __attribute__((always_inline)) { return older_terms<Value>(k, pull, rate, n); });
  };
  two_orders(
      2, sums_of([]<class Value>(const auto& pull, const auto& rate, const auto& n)
                     __attribute__((always_inline)) { return first_terms<Value>(pull, rate, n); }));
  if constexpr (is_single) {
    TermsByAge<Row> known = older(4);
    for (std::ptrdiff_t k = 4; k < order; k += 2) {
      const TermsByAge<Row> sums =
          sums_of([&]<class Value>(const auto& pull, const auto& rate, const auto& n)
                      __attribute__((always_inline)) {
                        return with_newest_terms<Value>(known, k, 1, pull, rate, n);
                      });
      if (k + 2 < order) known = older(k + 2);
      two_orders(k, sums);
    }
  } else {
    for (std::ptrdiff_t k = 4; k < order; k += 2) {
      two_orders(k, sums_of([k]<class Value>(const auto& pull, const auto& rate,
                                             const auto& n) __attribute__((always_inline)) {
                   return with_newest_terms<Value>(older_terms<Value>(k, pull, rate, n), k,
                                                   unknown_one(), pull, rate, n);
                 }));
    }
  }
}

}  // namespace pendcore
