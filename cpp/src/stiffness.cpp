#include "pendcore/integrate/stiffness.hpp"

namespace pendcore {

void test_stiffness(Stepper& stepper, double h, Position& position) {
  const double boundary = stepper.info().stability;
  if (boundary == 0.0) return;
  if (position.statistics.accepted % 1000 != 0 && position.stiff_hits == 0) return;
  if (stepper.stiffness(h) > boundary) {
    position.stiff_misses = 0;
    if (++position.stiff_hits != 15 || position.statistics.stiff) return;
    position.statistics.stiff = true;
    position.stiff_since = position.t.high + h;
    stepper.stiffness_found();
  } else if (++position.stiff_misses == 6) {
    position.stiff_hits = 0;
  }
}

}  // namespace pendcore
