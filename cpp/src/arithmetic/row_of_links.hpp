/// \file
/// A quantity of each of three or four links beside the same quantity of the others, as pair.hpp
/// has for two. If each lane has a trajectory, a row may also be of one link.
///
/// For one trajectory the row is a pack of four, whose last numbers are zero if there are fewer
/// links; for packs with a trajectory a lane it is as many of these. Sums and products are those of
/// the links.
#pragma once

#include "arithmetic/pair.hpp"

namespace pendcore {

/// One pack for each link.
template <class Real, int links>
struct EachLink {
  using Number = Real;
  static constexpr bool is_row = true;

  Real of[links];

  template <class Function, class... Rows>
  PENDCORE_INLINE static EachLink each(const Function& f, const Rows&... rows) {
    EachLink row;
#pragma GCC unroll 4
    for (int i = 0; i < links; ++i) row.of[i] = f(rows.of[i]...);
    return row;
  }
};

namespace row_detail {
template <class Number, int links>
struct RowOfLinks {
  using Type = EachLink<Number, links>;
};
template <int links>
struct RowOfLinks<double, links> {
  using Type = Pack<4>;
};

template <class Real, int links, class Function>
PENDCORE_INLINE EachLink<Real, links> each(const Function& function) {
  EachLink<Real, links> row;
#pragma GCC unroll 4
  for (int i = 0; i < links; ++i) row.of[i] = function(i);
  return row;
}
}  // namespace row_detail

template <class Number, int links>
using RowOfLinks = typename row_detail::RowOfLinks<Number, links>::Type;

template <class Real, int links>
PENDCORE_INLINE void sine_cosine(const EachLink<Real, links>& x, EachLink<Real, links>& sine,
                                 EachLink<Real, links>& cosine) {
  for (int i = 0; i < links; ++i) sine_cosine(x.of[i], sine.of[i], cosine.of[i]);
}

/// The value at the joint before, and at the joint after; 0 beyond the ends of the chain.
PENDCORE_INLINE Pack<4> before(const Pack<4>& x) {
  return __builtin_shufflevector(x, Pack<4>{}, 4, 0, 1, 2);
}
PENDCORE_INLINE Pack<4> after(const Pack<4>& x) {
  return __builtin_shufflevector(x, Pack<4>{}, 1, 2, 3, 4);
}
/// The same in a row that is not alone, from what was stored as packs (pack.hpp).
PENDCORE_INLINE Pack<4> before(const Pack<4>& x, const Pack<4>& row_before) {
  return __builtin_shufflevector(row_before, x, 3, 4, 5, 6);
}
PENDCORE_INLINE Pack<4> after(const Pack<4>& x, const Pack<4>& row_after) {
  return __builtin_shufflevector(x, row_after, 1, 2, 3, 4);
}
template <class Real, int links>
PENDCORE_INLINE EachLink<Real, links> before(const EachLink<Real, links>& x) {
  return row_detail::each<Real, links>(
      [&](int i) __attribute__((always_inline)) { return i == 0 ? Real{} : x.of[i - 1]; });
}
template <class Real, int links>
PENDCORE_INLINE EachLink<Real, links> after(const EachLink<Real, links>& x) {
  return row_detail::each<Real, links>(
      [&](int i) __attribute__((always_inline)) { return i + 1 == links ? Real{} : x.of[i + 1]; });
}

template <class Real, int links>
struct Constants<EachLink<Real, links>> {
  using Row = EachLink<Real, links>;
  PENDCORE_INLINE static Row of(const Row& x) { return x; }
  PENDCORE_INLINE static Row of(const Real& x) {
    return row_detail::each<Real, links>([&](int) __attribute__((always_inline)) { return x; });
  }
  PENDCORE_INLINE static Row of(double x) { return of(broadcast<Real>(x)); }
};

/// The number of one link.
PENDCORE_INLINE double number_of(const Pack<4>& row, int i) { return row[i]; }
template <class Real, int links>
PENDCORE_INLINE const Real& number_of(const EachLink<Real, links>& row, int i) {
  return row.of[i];
}
PENDCORE_INLINE void set_number(Pack<4>& row, int i, double x) { row[i] = x; }
template <class Real, int links>
PENDCORE_INLINE void set_number(EachLink<Real, links>& row, int i, const Real& x) {
  row.of[i] = x;
}

/// The sum of the numbers that one trajectory has in a row, and how many they are.
template <class Row>
PENDCORE_INLINE double sum_of_numbers(const Row& x) {
  return sum_of_lanes(x);
}
template <class Real, int links>
PENDCORE_INLINE Real sum_of_numbers(const EachLink<Real, links>& x) {
  Real sum = x.of[0];
#pragma GCC unroll 4
  for (int i = 1; i < links; ++i) sum = sum + x.of[i];
  return sum;
}
template <class Real>
PENDCORE_INLINE Real sum_of_numbers(const Two<Real>& x) {
  return x.first + x.second;
}
template <class Row>
constexpr int count_of_numbers = Lanes<Row>::width;
template <class Real, int links>
constexpr int count_of_numbers<EachLink<Real, links>> = links;
template <class Real>
constexpr int count_of_numbers<Two<Real>> = 2;

/// Gives each link the number of the link `by` places after; the first follows the last.
template <int links, int by>
PENDCORE_INLINE Pack<4> link_after(const Pack<4>& row) {
  const auto from = [](int i) { return i < links ? (i + by) % links : i; };
  return __builtin_shufflevector(row, row, from(0), from(1), from(2), from(3));
}
template <int links, int by, class Real>
PENDCORE_INLINE EachLink<Real, links> link_after(const EachLink<Real, links>& row) {
  return row_detail::each<Real, links>(
      [&](int i) __attribute__((always_inline)) { return row.of[(i + by) % links]; });
}

}  // namespace pendcore
