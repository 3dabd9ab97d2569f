/// \file
/// A quantity of link 1 beside the same quantity of link 2.
///
/// The equations of a double pendulum are the same for both links in terms of a link and the other
/// link. They are written for a pair, and `other` exchanges its two numbers. For one trajectory the
/// pair is a pack of two, so that both links cost one instruction. For any other number type (a
/// pack that holds many trajectories, a dual number) the pair is two of these numbers.
#pragma once

#include <bit>

#include "arithmetic/pack.hpp"
#include "arithmetic/sine_cosine.hpp"

namespace pendcore {

template <class Real>
struct Two {
  Real first;
  Real second;
};

using Pair = Pack<2>;

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
/// x + y in both halves.
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

template <class Real>
PENDCORE_INLINE Two<Real> operator-(const Two<Real>& x) {
  return {-x.first, -x.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator+(const Two<Real>& x, const Two<Real>& y) {
  return {x.first + y.first, x.second + y.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator-(const Two<Real>& x, const Two<Real>& y) {
  return {x.first - y.first, x.second - y.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator*(const Two<Real>& x, const Two<Real>& y) {
  return {x.first * y.first, x.second * y.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator*(const Two<Real>& x, double y) {
  return {x.first * y, x.second * y};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator/(const Two<Real>& x, const Two<Real>& y) {
  return {x.first / y.first, x.second / y.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator/(double x, const Two<Real>& y) {
  return {x / y.first, x / y.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> fma(const Two<Real>& a, const Two<Real>& b, const Two<Real>& c) {
  return {fma(a.first, b.first, c.first), fma(a.second, b.second, c.second)};
}
template <class Real>
PENDCORE_INLINE void sine_cosine(const Two<Real>& x, Two<Real>& sine, Two<Real>& cosine) {
  sine_cosine(x.first, sine.first, cosine.first);
  sine_cosine(x.second, sine.second, cosine.second);
}

template <class Real>
PENDCORE_INLINE Two<Real> absolute(const Two<Real>& x) {
  return {absolute(x.first), absolute(x.second)};
}
template <class Real>
PENDCORE_INLINE Two<Real> larger(const Two<Real>& a, const Two<Real>& b) {
  return {larger(a.first, b.first), larger(a.second, b.second)};
}

/// A number of each trajectory times, or divided by, both numbers of a pair.
template <class Real>
PENDCORE_INLINE Two<Real> fma(const Real& a, const Two<Real>& b, const Two<Real>& c) {
  return {fma(a, b.first, c.first), fma(a, b.second, c.second)};
}
template <class Real>
  requires(Lanes<Real>::width > 1)
PENDCORE_INLINE Two<Real> operator*(const Real& x, const Two<Real>& y) {
  return {x * y.first, x * y.second};
}
template <class Real>
PENDCORE_INLINE Two<Real> operator*(double x, const Two<Real>& y) {
  return {x * y.first, x * y.second};
}
template <class Real>
  requires(Lanes<Real>::width > 1)
PENDCORE_INLINE Two<Real> operator/(const Real& x, const Two<Real>& y) {
  return {x / y.first, x / y.second};
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
