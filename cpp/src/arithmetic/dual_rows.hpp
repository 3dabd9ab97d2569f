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

PENDCORE_LINEAR_FUNCTION(joined)
PENDCORE_LINEAR_FUNCTION(low_half)
PENDCORE_LINEAR_FUNCTION(high_half)
PENDCORE_LINEAR_FUNCTION(twice)
PENDCORE_LINEAR_FUNCTION(halves_added)
PENDCORE_LINEAR_FUNCTION(turned)

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
