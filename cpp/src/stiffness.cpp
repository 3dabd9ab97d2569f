#include "pendcore/integrate/stiffness.hpp"

namespace pendcore {

void test_stiffness(Stepper& stepper, double h, Position& position) {
  const double boundary = stepper.info().stability;
  if (boundary == 0.0) return;
  constexpr int first_look = 100;
  if (position.statistics.accepted % 1000 != first_look && position.stiff_hits == 0) return;
  if (stepper.stiffness(h) > boundary) {
    position.stiff_misses = 0;
    if (++position.stiff_hits != 15) return;
    const bool is_told_again = stepper.stiffness_found(position.h_is_max_step);
    if (is_told_again) position.stiff_hits = 0;
    if (is_told_again || !position.statistics.stiff) position.stiff_since = position.t.high + h;
    position.statistics.stiff = true;
  } else if (++position.stiff_misses == 6) {
    position.stiff_hits = 0;
  }
}

}  // namespace pendcore
