/// \file
/// Whether the mass matrix of the joints that can move is singular at some configuration that the
/// chain can reach. The accelerations would have no bound there.
///
/// It is singular where rates that are not all zero have no kinetic energy. Locks make links one
/// rigid body. From the tip to the base, the motions of a body and all beyond it that have no
/// energy are told by rho = |v|, the speed of its joint, and omega, the rate of the body before,
/// which matters only to a rotor in the joint. The angles are free, so that rho / |omega| fills one
/// interval. A body with an inertia does not turn, one with a mass does not move at its mass
/// centre, a rotor turns both its bodies at one rate, and a body without any of these turns as it
/// likes. Where a body turns although its joint rests, the mass matrix is singular.
///
/// Stops matter where the next joint can move only across one axis of its body: they may keep the
/// body before from lining up with that axis.
/// Cost: O(n).
#pragma once

#include <string>

#include "pendcore/scene.hpp"

namespace pendcore {

/// Names the link that no kinetic energy keeps from turning, why, and the remedy; empty for a scene
/// whose mass matrix is regular. Where this depends on a lock without an angle, which takes that of
/// the start, nothing is said: check_start() asks again with the angle.
std::string singular_somewhere(const Scene& scene);

}  // namespace pendcore
