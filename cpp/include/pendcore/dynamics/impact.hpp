/// \file
/// Impacts of joints on their stops, by HeldJoints::strike (held_joints.hpp).
///
/// The problem of joint_forces.hpp in rates phid and impulses Lambda, over the closed stops that no
/// joint leaves (phid- <= 0, counted positive away from the stop):
///
///     0 <= Lambda,  phid+ + e phid- >= 0,  Lambda (phid+ + e phid-) = 0
///
/// so that it takes sum (1 - e) Lambda |phid-| / 2 >= 0 of the energy, whatever the e. A joint that
/// was leaving its stop and is thrown back strikes in turn, at the same time. Friction gives no
/// impulse.
/// Source: Brogliato, Nonsmooth Mechanics (2016), section 5.2, for one impact.
#pragma once

namespace pendcore {

/// What an impact took from the chain, and what the drive of the pivot gave in it, J.
struct Impact {
  double loss = 0.0;
  double work_of_drive = 0.0;
};

}  // namespace pendcore
