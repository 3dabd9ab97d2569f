/// \file
/// How far a Taylor series goes, and the divisors of its recurrences.
#pragma once

#include <array>

namespace pendcore {

inline constexpr int highest_order = 32;  ///< that there is room for; tolerances ask for less

/// 1/k
inline constexpr auto inverse_of = [] {
  std::array<double, highest_order + 3> table{};
  for (int k = 1; k < static_cast<int>(table.size()); ++k) table[k] = 1.0 / k;
  return table;
}();

}  // namespace pendcore
