/// \file
/// What resume() asks of a scene, a solution and the times of a continuation.
#pragma once

#include <vector>

#include "pendcore/scene.hpp"
#include "pendcore/solution.hpp"

namespace pendcore {

/// Checks that a run is continued with its own scene from where it ended, to times that it has not
/// been asked for.
void check_continuation(const Scene& scene, const Solution& solution, double t_end,
                        const std::vector<double>& t_eval);

}  // namespace pendcore
