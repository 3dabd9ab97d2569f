/// \file
/// Where numbers stop being finite: which rate, and by whose force.
#pragma once

#include "pendcore/integrate/loop/integrate.hpp"
#include "pendcore/scene/scene.hpp"

namespace pendcore {

struct NotFinite {
  int component = -1;  ///< of (q, qd)
  int effect = -1;     ///< of the scene, that gives no number by itself; -1: none does
};

/// Looks ahead along the slope at which a run has ended, as far as its last steps tried, each
/// longer than the next; not beyond t_end.
NotFinite find_what_is_not_finite(const Scene& scene, const IntegratorState& integrator,
                                  double t_end);

}  // namespace pendcore
