/// \file
/// Dual numbers of each link beside those of the other links: the operations of pair.hpp and
/// row_of_links.hpp on dual rows.
#pragma once

#include "arithmetic/dual.hpp"

namespace pendcore {

namespace row_detail {
template <int links>
struct RowOfLinks<Dual<double>, links> {
  using Type = Dual<Pack<4>>;
};
}  // namespace row_detail

PENDCORE_INLINE Dual<Pairs> joined(const Dual<Pair>& low, const Dual<Pair>& high) {
  return {joined(low.value, high.value), joined(low.slope, high.slope)};
}
PENDCORE_INLINE Dual<Pair> low_half(const Dual<Pairs>& x) {
  return {low_half(x.value), low_half(x.slope)};
}
PENDCORE_INLINE Dual<Pair> high_half(const Dual<Pairs>& x) {
  return {high_half(x.value), high_half(x.slope)};
}
PENDCORE_INLINE Dual<Pairs> twice(const Dual<Pair>& x) { return {twice(x.value), twice(x.slope)}; }
PENDCORE_INLINE Dual<Pairs> halves_added(const Dual<Pairs>& x) {
  return {halves_added(x.value), halves_added(x.slope)};
}
PENDCORE_INLINE Dual<Pairs> turned(const Dual<Pairs>& x) {
  return {turned(x.value), turned(x.slope)};
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
