/// \file
/// Steps of a motion and of small changes of its state: the variational equations of lyapunov.hpp.
#pragma once

#include <memory>

#include "integrate/stepper.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// A stepper of the state and `count` changes of it, in rows (q, dq_1 .. dq_k) and
/// (qd, dqd_1 .. dqd_k), for a run to t_end. It takes Taylor series where those of
/// dynamics/series/double_pendulum_series.hpp or few_links_series.hpp hold along the whole run, and
/// dop853 for all other scenes. Cost: for each change, that of the motion's series on dual numbers,
/// which has the motion each time; or that of a right-hand side on dual numbers.
std::unique_ptr<Stepper> tangent_stepper(const Scene& scene, int count, double t_end, bool forward);

}  // namespace pendcore
