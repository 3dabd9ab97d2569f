/// \file
/// What a run says of how it ended.
#pragma once

#include <string>

#include "pendcore/simulate/solution.hpp"

namespace pendcore {

/// What happened, with advice; of a run that failed, where. `remark` is what holds a scene at rest,
/// `ended_by` the number of the event that ended the run, from 0; `integrator` is where it stands.
std::string ending_message(const Ending& ending, const Scene& scene, const Solution& solution,
                           const IntegratorState& integrator, const std::string& remark,
                           int ended_by);

}  // namespace pendcore
