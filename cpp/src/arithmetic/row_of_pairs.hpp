/// \file
/// Two pairs beside each other, in which each number is a pack with one trajectory a lane. For a
/// single trajectory they are Pairs (pair.hpp). Sums and products are those of pairs.
#pragma once

#include "arithmetic/pair.hpp"

namespace pendcore {

template <class Real>
using TwoPairs = Two<Two<Real>>;

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
  return x.first;
}
template <class Real>
PENDCORE_INLINE Two<Real> high_half(const TwoPairs<Real>& x) {
  return x.second;
}
/// The numbers of the other link, in both pairs.
template <class Real>
PENDCORE_INLINE TwoPairs<Real> other(const TwoPairs<Real>& x) {
  return {other(x.first), other(x.second)};
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> halves_added(const TwoPairs<Real>& x) {
  return twice(x.first + x.second);
}
template <class Real>
PENDCORE_INLINE TwoPairs<Real> turned(const TwoPairs<Real>& x) {
  return {-x.second, x.first};
}

template <class Real>
struct Constants<TwoPairs<Real>> {
  PENDCORE_INLINE static TwoPairs<Real> of(double x) { return twice(Constants<Two<Real>>::of(x)); }
};

}  // namespace pendcore
