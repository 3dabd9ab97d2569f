/// \file
/// Dual numbers of each link beside those of the other links: the operations of pair.hpp and
/// row_of_links.hpp on dual rows.
#pragma once

#include <utility>

#include "arithmetic/dual.hpp"
#include "arithmetic/row_of_pairs.hpp"

namespace pendcore {

namespace row_detail {
template <int links>
struct RowOfLinks<Dual<double>, links> {
  using Type = Dual<Pack<4>>;
};
}  // namespace row_detail

PENDCORE_LINEAR_FUNCTION(joined)
PENDCORE_LINEAR_FUNCTION(low_half)
PENDCORE_LINEAR_FUNCTION(high_half)
PENDCORE_LINEAR_FUNCTION(twice)
PENDCORE_LINEAR_FUNCTION(halves_added)
PENDCORE_LINEAR_FUNCTION(turned)

// A pair with slopes along several directions: the values are one pack, and the slopes of each
// number another one.

template <class Slopes>
using PairAlong = Dual<Pair, Two<Slopes>>;
namespace pair_detail {
template <class Slopes>
  requires(Lanes<Slopes>::width > 1)
struct PairOf<Dual<double, Slopes>> {
  using Type = PairAlong<Slopes>;
};
}  // namespace pair_detail

template <class Slopes>
PENDCORE_INLINE PairAlong<Slopes> pair_of(const Dual<double, Slopes>& first,
                                          const Dual<double, Slopes>& second) {
  return {Pair{first.value, second.value}, {first.slope, second.slope}};
}
template <class Slopes>
PENDCORE_INLINE Dual<double, Slopes> number_of(const PairAlong<Slopes>& x, int k) {
  return {x.value[k], number_of(x.slope, k)};
}
template <class Slopes>
PENDCORE_INLINE void set_number(PairAlong<Slopes>& x, int k, const Dual<double, Slopes>& number) {
  set_number(x.value, k, number.value);
  set_number(x.slope, k, number.slope);
}
/// A number times both numbers of a pair.
template <class Slopes>
PENDCORE_INLINE PairAlong<Slopes> fma(const Dual<double, Slopes>& a, const PairAlong<Slopes>& b,
                                      const PairAlong<Slopes>& c) {
  return fma(pair_of(a, a), b, c);
}

PENDCORE_INLINE Dual<double> number_of(const Dual<Pack<4>>& row, int i) {
  return {row.value[i], row.slope[i]};
}
PENDCORE_INLINE void set_number(Dual<Pack<4>>& row, int i, const Dual<double>& x) {
  row.value[i] = x.value;
  row.slope[i] = x.slope;
}
template <int links, int by>
PENDCORE_INLINE Dual<Pack<4>> link_after(const Dual<Pack<4>>& row) {
  return {link_after<links, by>(row.value), link_after<links, by>(row.slope)};
}

}  // namespace pendcore
