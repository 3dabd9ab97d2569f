/// \file
/// The highest order of a Taylor series, the divisors of its recurrences, and products of series.
#pragma once

#include <array>

#include "arithmetic/pair.hpp"

namespace pendcore {

inline constexpr int highest_order = 32;  ///< memory is for so many; tolerances need fewer

/// 1/k
inline constexpr auto inverse_of = [] {
  std::array<double, highest_order + 3> table{};
  for (int k = 1; k < static_cast<int>(table.size()); ++k) table[k] = 1.0 / k;
  return table;
}();

/// Order k of the product of two series, which are functions of the order: sum_j a(j) b(k - j).
template <class First, class Second>
PENDCORE_INLINE auto order_of_product(int k, const First& a, const Second& b) {
  decltype(a(0)) sum{};
  for (int j = 0; j <= k; ++j) sum = fma(a(j), b(k - j), sum);
  return sum;
}

}  // namespace pendcore
