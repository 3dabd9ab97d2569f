#include "integrate/loop/stiffness.hpp"

namespace pendcore {

void test_stiffness(Stepper& stepper, double h, IntegratorState& integrator) {
  const double boundary = stepper.info().stability;
  if (boundary == 0.0) return;
  const long long steps = integrator.statistics.accepted;
  if (steps % stiffness_looks_every != first_stiffness_look && integrator.stiff_hits == 0) return;
  if (stepper.stiffness(h) > boundary) {
    integrator.stiff_misses = 0;
    if (++integrator.stiff_hits != 15) return;
    const bool is_told_again = stepper.stiffness_found(integrator.h_is_max_step);
    if (is_told_again) integrator.stiff_hits = 0;
    if (is_told_again || !integrator.statistics.stiff)
      integrator.stiff_since = integrator.t.high + h;
    integrator.statistics.stiff = true;
  } else if (++integrator.stiff_misses == 6) {
    integrator.stiff_hits = 0;
  }
}

}  // namespace pendcore
