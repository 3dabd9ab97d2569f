/// \file
/// Where numbers stop being finite: in which component, and by which effect.
#pragma once

#include "integrate/loop/integrate.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

struct NotFinite {
  int component = -1;  ///< the component of (q, qd), or -1
  int effect = -1;     ///< the effect that is not finite by itself, or -1
};

/// Looks ahead along the slope at the end of a run, as far as the run's last attempts reached: each
/// attempt was longer than the next. It does not look beyond t_end.
NotFinite find_what_is_not_finite(const Scene& scene, const IntegratorState& integrator,
                                  double t_end);

}  // namespace pendcore
