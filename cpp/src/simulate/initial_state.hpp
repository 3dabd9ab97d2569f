/// \file
/// The conditions that the start and the interval of a run must satisfy, and its continuation.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pendcore/scene.hpp"
#include "pendcore/solution.hpp"

namespace pendcore {

/// Throws std::invalid_argument, naming the argument, for angles and rates that are not one finite
/// number for each link, for times that are not finite, and for what the effects of the scene do
/// not allow: a locked joint that turns, a joint beyond its stops, time that runs backward where
/// the past is not unique.
void check_start(const Scene& scene, std::span<const double> q0, std::span<const double> qd0,
                 double t0, double t_end);
/// Checks that a run is continued with its own scene from where it ended, to times that it has not
/// been asked for.
void check_continuation(const Scene& scene, const Solution& solution, double t_end,
                        const std::vector<double>& t_eval);
/// Warnings of what is possible in a run but hardly intended, a sentence each: a start that looks
/// like degrees, a table that ends before the run does.
std::vector<std::string> run_warnings(const Scene& scene, std::span<const double> q0, double t0,
                                      double t_end);

/// Whether time t is outside the table or spline of an effect, in the direction of the run.
bool is_outside_table(const EffectBehaviour& effect, double t, bool forward);

/// "its table goes from 0 to 1 s", for an effect that has a table or spline.
std::string span_of(const EffectBehaviour& effect);

}  // namespace pendcore
