/// \file
/// A quantity of link 1 beside the same quantity of link 2.
///
/// The equations of a double pendulum are the same for both links in terms of a link and the other
/// link. They are written for a pair, and `other` exchanges its two numbers. For one trajectory the
/// pair is a pack of two, so that both links cost one instruction. For any other number type (a
/// pack that holds many trajectories, a dual number) the pair is two of these numbers.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>

#include "arithmetic/pack.hpp"
#include "arithmetic/sine_cosine.hpp"

namespace pendcore {

template <class Real>
struct Two {
  using Number = Real;
  static constexpr bool is_row = true;

  Real first;
  Real second;

  /// The row of f(x, ...) of the numbers of rows.
  template <class Function, class... Rows>
  PENDCORE_INLINE static Two each(const Function& f, const Rows&... rows) {
    return {f(rows.first...), f(rows.second...)};
  }
};

using Pair = Pack<2>;

/// Calls use<Row>() with the kind of row that n links, or as many numbers, are taken in.
template <class Use>
PENDCORE_INLINE auto with_row_for(std::size_t n, const Use& use) {
  if (n == 1) return use.template operator()<double>();
  if (n == 2) return use.template operator()<Pair>();
  return use.template operator()<Pack<4>>();
}

namespace pair_detail {
template <class Number>
struct PairOf {
  using Type = Two<Number>;
};
template <>
struct PairOf<double> {
  using Type = Pair;
};
}  // namespace pair_detail

/// The pair for a number type: a pack of two doubles, or two packs.
template <class Number>
using PairOf = typename pair_detail::PairOf<Number>::Type;

/// (x_2, x_1). The empty instruction keeps GCC 12 from seeing through the exchange: it would
/// compute whatever depends on it twice, in both orders.
PENDCORE_INLINE Pair other(const Pair& x) {
  Pair exchanged = __builtin_shufflevector(x, x, 1, 0);
#if defined(__x86_64__)
  asm("" : "+v"(exchanged));
#endif
  return exchanged;
}
template <class Real>
PENDCORE_INLINE Two<Real> other(const Two<Real>& x) {
  return {x.second, x.first};
}

/// Number k of the pair, counted from 0.
PENDCORE_INLINE double number_of(const Pair& x, int k) { return x[k]; }
template <class Real>
PENDCORE_INLINE const Real& number_of(const Two<Real>& x, int k) {
  return k == 0 ? x.first : x.second;
}

PENDCORE_INLINE void set_number(Pair& x, int k, double value) { x[k] = value; }
template <class Real>
PENDCORE_INLINE void set_number(Two<Real>& x, int k, const Real& value) {
  (k == 0 ? x.first : x.second) = value;
}

/// Two pairs beside each other: (x_1, x_2, y_1, y_2).
using Pairs = Pack<4>;

PENDCORE_INLINE Pairs other(const Pairs& x) { return __builtin_shufflevector(x, x, 1, 0, 3, 2); }
PENDCORE_INLINE Pairs twice(const Pair& x) { return joined(x, x); }
PENDCORE_INLINE Pairs halves_swapped(const Pairs& x) {
  return __builtin_shufflevector(x, x, 2, 3, 0, 1);
}
PENDCORE_INLINE Pairs halves_added(const Pairs& x) { return x + halves_swapped(x); }
/// (-y, x): vectors in the plane, turned by a right angle.
PENDCORE_INLINE Pairs turned(const Pairs& x) {
  using Integers = Lanes<Pairs>::Integers;
  constexpr long long minus = 1LL << 63;
  return std::bit_cast<Pairs>(std::bit_cast<Integers>(halves_swapped(x)) ^
                              Integers{minus, minus, 0, 0});
}

/// Converts constants to the number type of a computation: one number for all lanes, or a row of
/// them.
template <class Links>
struct Constants {
  PENDCORE_INLINE static Links of(const Links& x) { return x; }
  PENDCORE_INLINE static Links of(double x) { return broadcast<Links>(x); }
};
template <>
struct Constants<double> {
  PENDCORE_INLINE static double of(double x) { return x; }
};
template <class Real>
struct Constants<Two<Real>> {
  PENDCORE_INLINE static Two<Real> of(const Pair& x) {
    return {broadcast<Real>(x[0]), broadcast<Real>(x[1])};
  }
  PENDCORE_INLINE static Two<Real> of(double x) { return {broadcast<Real>(x), broadcast<Real>(x)}; }
  PENDCORE_INLINE static Two<Real> of(const Real& x)
    requires(Lanes<Real>::width > 1)
  {
    return {x, x};
  }
  PENDCORE_INLINE static Two<Real> of(const Two<Real>& x) { return x; }
};

/// The value at the joint before, and at the joint after; 0 beyond the ends of the chain.
/// phi_j = q_j - q_{j-1} is q - before(q), tau_j - tau_{j+1} is tau - after(tau).
PENDCORE_INLINE double before(double) { return 0.0; }
PENDCORE_INLINE double after(double) { return 0.0; }
PENDCORE_INLINE Pair before(const Pair& x) { return __builtin_shufflevector(x, Pair{}, 2, 0); }
PENDCORE_INLINE Pair after(const Pair& x) { return __builtin_shufflevector(x, Pair{}, 1, 2); }
template <class Real>
PENDCORE_INLINE Two<Real> before(const Two<Real>& x) {
  return {broadcast<Real>(0.0), x.first};
}
template <class Real>
PENDCORE_INLINE Two<Real> after(const Two<Real>& x) {
  return {x.second, broadcast<Real>(0.0)};
}

/// Numbers of several links that are no pack: Two, and EachLink (row_of_links.hpp). Sums, products
/// and functions of rows are those of their numbers.
template <class Row>
concept RowOfNumbers = Row::is_row;
/// One number of each trajectory, or of all.
template <class Number, class Row>
concept FactorOf = std::same_as<Number, double> || std::same_as<Number, typename Row::Number>;

template <RowOfNumbers Row>
PENDCORE_INLINE Row operator-(const Row& x) {
  return Row::each([](const auto& a) __attribute__((always_inline)) { return -a; }, x);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row operator+(const Row& x, const Row& y) {
  return Row::each(
      [](const auto& a, const auto& b) __attribute__((always_inline)) { return a + b; }, x, y);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row operator-(const Row& x, const Row& y) {
  return Row::each(
      [](const auto& a, const auto& b) __attribute__((always_inline)) { return a - b; }, x, y);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row operator*(const Row& x, const Row& y) {
  return Row::each(
      [](const auto& a, const auto& b) __attribute__((always_inline)) { return a * b; }, x, y);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row operator/(const Row& x, const Row& y) {
  return Row::each(
      [](const auto& a, const auto& b) __attribute__((always_inline)) { return a / b; }, x, y);
}
template <RowOfNumbers Row, FactorOf<Row> Factor>
PENDCORE_INLINE Row operator*(const Factor& x, const Row& y) {
  return Row::each([&](const auto& a) __attribute__((always_inline)) { return x * a; }, y);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row operator*(const Row& x, double y) {
  return Row::each([y](const auto& a) __attribute__((always_inline)) { return a * y; }, x);
}
template <RowOfNumbers Row, FactorOf<Row> Factor>
PENDCORE_INLINE Row operator/(const Factor& x, const Row& y) {
  return Row::each([&](const auto& a) __attribute__((always_inline)) { return x / a; }, y);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row fma(const Row& a, const Row& b, const Row& c) {
  return Row::each([](const auto& x, const auto& y, const auto& z)
                       __attribute__((always_inline)) { return fma(x, y, z); },
                   a, b, c);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row fma(const typename Row::Number& a, const Row& b, const Row& c) {
  return Row::each([&](const auto& y, const auto& z)
                       __attribute__((always_inline)) { return fma(a, y, z); },
                   b, c);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row absolute(const Row& x) {
  return Row::each([](const auto& a) __attribute__((always_inline)) { return absolute(a); }, x);
}
template <RowOfNumbers Row>
PENDCORE_INLINE Row larger(const Row& x, const Row& y) {
  return Row::each([](const auto& a, const auto& b)
                       __attribute__((always_inline)) { return larger(a, b); },
                   x, y);
}
template <class Real>
PENDCORE_INLINE void sine_cosine(const Two<Real>& x, Two<Real>& sine, Two<Real>& cosine) {
  sine_cosine(x.first, sine.first, cosine.first);
  sine_cosine(x.second, sine.second, cosine.second);
}

/// A number of each link times the slopes of that link's number.
template <class Slopes>
  requires(Lanes<Slopes>::width > 2)
PENDCORE_INLINE Two<Slopes> operator*(const Pair& x, const Two<Slopes>& y) {
  return {x[0] * y.first, x[1] * y.second};
}
template <class Slopes>
  requires(Lanes<Slopes>::width > 2)
PENDCORE_INLINE Two<Slopes> operator*(const Two<Slopes>& x, const Pair& y) {
  return y * x;
}
template <class Slopes>
  requires(Lanes<Slopes>::width > 2)
PENDCORE_INLINE Two<Slopes> operator/(const Two<Slopes>& x, const Pair& y) {
  return {x.first / y[0], x.second / y[1]};
}
template <class Slopes>
  requires(Lanes<Slopes>::width > 2)
PENDCORE_INLINE Two<Slopes> fma(const Pair& a, const Two<Slopes>& b, const Two<Slopes>& c) {
  return {fma(a[0], b.first, c.first), fma(a[1], b.second, c.second)};
}
template <class Slopes>
  requires(Lanes<Slopes>::width > 2)
PENDCORE_INLINE Two<Slopes> fma(double a, const Two<Slopes>& b, const Two<Slopes>& c) {
  return {fma(a, b.first, c.first), fma(a, b.second, c.second)};
}

}  // namespace pendcore
