/// \file
/// Which form of the equations of motion a scene calls for.
///
/// A scene is compiled once, into a kernel that holds what the scene has and nothing else.
#pragma once

#include <variant>

#include "pendcore/dynamics/double_pendulum.hpp"
#include "pendcore/dynamics/single_pendulum.hpp"

namespace pendcore {

using EquationsOfMotion = std::variant<SinglePendulum, DoublePendulum>;

/// Of a scene that check() passed. Throws std::invalid_argument for more than two links.
EquationsOfMotion equations_of_motion(const Scene& scene);

/// qdd (rad/s^2) from the time (s), angles (rad) and rates (rad/s), (n) each; the same bits as in
/// a run. Cost: a right-hand side. Throws nothing.
void accelerations(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
                   double* qdd);

}  // namespace pendcore
