#include "integrate/taylor/taylor.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/order_of_series.hpp"
#include "arithmetic/power.hpp"
#include "integrate/events/root.hpp"

namespace pendcore {

static_assert(highest_order <= highest_degree, "events are zeros of the series");

int taylor_order(double tolerance) {
  constexpr double log10_of_2 = 0.30102999566398120;
  const double digits = -log10_of_2 * approximate_log2(tolerance);
  const int order = 2 * static_cast<int>(std::lround(0.5 * (5.0 + 1.5 * digits)));
  return std::clamp(order, lowest_taylor_order, highest_order);
}

}  // namespace pendcore
