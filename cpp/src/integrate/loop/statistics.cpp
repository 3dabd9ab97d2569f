#include "pendcore/integrate/loop/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace pendcore {

void count_accepted(Statistics& statistics, double h, bool cut, bool at_max_step) {
  ++statistics.accepted;
  ++(cut           ? statistics.limited_by_break
     : at_max_step ? statistics.limited_by_max_step
                   : statistics.limited_by_tolerance);
  const long long uncut = statistics.accepted - statistics.limited_by_break;
  if (cut && uncut > 0) return;
  const double size = std::abs(h);
  const bool first = uncut <= 1;
  statistics.min_step = first ? size : std::min(statistics.min_step, size);
  statistics.max_step = first ? size : std::max(statistics.max_step, size);
}

}  // namespace pendcore
