/// \file
/// The message at the end of a run.
#pragma once

#include <string>

#include "dynamics/equations_of_motion.hpp"
#include "integrate/loop/integrate.hpp"
#include "pendcore/solution.hpp"

namespace pendcore {

/// Says what happened, with advice, and where a failed run ended. `remark` says what holds a scene
/// at rest; `ended_by` is the number of the event that ended the run, from 0; `integrator` is the
/// state of the run at its end.
std::string ending_message(const Ending& ending, const Scene& scene, const Solution& solution,
                           const IntegratorState& integrator, const std::string& remark,
                           int ended_by);

/// What the message goes on to say about the steps, "; ..." or nothing: whether stability limited
/// them, since when, and what to do; which mode set them, if one did for long; whether the run
/// changed its method to the one with which it ended; which effects were differentiated
/// numerically.
std::string remark_on_steps(const Scene& scene, const EquationsOfMotion& equations,
                            const Solution& solution, const IntegratorState& integrator);

}  // namespace pendcore
