/// \file
/// From a scene and a start to a solution.
#pragma once

#include <optional>

#include "pendcore/scene.hpp"
#include "pendcore/solution.hpp"

namespace pendcore {

/// Simulates the scene from angles q0 (rad, n) and rates qd0 (rad/s, n) over t0 .. t_end (s), which
/// may run backward:
///
///     const Solution run = simulate(Scene::textbook(), {pi / 4, pi / 3}, {0.0, 0.0}, 0.0, 5.0);
///     const double second_angle = run.back().q(1);
///
/// Throws std::invalid_argument for bad input, naming the argument. A run that fails returns what
/// it has, with a status and a message that say why.
Solution simulate(const Scene& scene, const Numbers& q0, const Numbers& qd0, double t0,
                  double t_end, Options options = {});

/// The solution of the same run of the same scene, continued to t_end, bit for bit as if it had
/// never stopped. `t_eval` names further times of a run that was asked for times; max_steps,
/// time_limit and monitor count for this leg. Throws std::invalid_argument for an end, or times,
/// that the run has passed, for a scene with other links or parameters, and for a solution that is
/// empty.
Solution resume(const Scene& scene, const Solution& solution, double t_end,
                const NumberList& t_eval = {}, long long max_steps = 10'000'000,
                std::optional<double> time_limit = {}, const Monitor& monitor = {});

}  // namespace pendcore
