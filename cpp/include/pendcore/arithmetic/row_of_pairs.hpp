/// \file
/// Two pairs beside each other, in which each number is a pack with one trajectory a lane. For a
/// single trajectory they are Pairs (pair.hpp).
#pragma once

#include "pendcore/arithmetic/pair.hpp"

namespace pendcore {

template <class Real>
struct TwoPairs {
  Two<Real> low;
  Two<Real> high;
};

template <class Real>
PENDCORE_INLINE TwoPairs<Real> joined(const Two<Real>& low, const Two<Real>& high) {
  return {low, high};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> twice(const Two<Real>& x) {
  return {x, x};
}
template <class Real>
PENDCORE_INLINE Two<Real> low_half(const TwoPairs<Real>& x) {
  return x.low;
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> other(const TwoPairs<Real>& x) {
  return {other(x.low), other(x.high)};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> halves_added(const TwoPairs<Real>& x) {
  const Two<Real> sum = x.low + x.high;
  return {sum, sum};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> turned(const TwoPairs<Real>& x) {
  return {-x.high, x.low};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> operator-(const TwoPairs<Real>& x) {
  return {-x.low, -x.high};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> operator+(const TwoPairs<Real>& x, const TwoPairs<Real>& y) {
  return {x.low + y.low, x.high + y.high};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> operator-(const TwoPairs<Real>& x, const TwoPairs<Real>& y) {
  return {x.low - y.low, x.high - y.high};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> operator*(const TwoPairs<Real>& x, const TwoPairs<Real>& y) {
  return {x.low * y.low, x.high * y.high};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> operator*(double x, const TwoPairs<Real>& y) {
  return {x * y.low, x * y.high};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> fma(const TwoPairs<Real>& a, const TwoPairs<Real>& b,
                                   const TwoPairs<Real>& c) {
  return {fma(a.low, b.low, c.low), fma(a.high, b.high, c.high)};
}

template <class Real>
struct Constants<TwoPairs<Real>> {
  PENDCORE_INLINE static TwoPairs<Real> of(double x) { return twice(Constants<Two<Real>>::of(x)); }
};

}  // namespace pendcore
