/// \file
/// What can hold the joints of a scene: locks, dry friction, and the stops at the ends of a range.
#pragma once

#include <vector>

#include "pendcore/dynamics/inertia.hpp"
#include "pendcore/effects/law.hpp"
#include "pendcore/scene/scene.hpp"

namespace pendcore {

/// Which end of its range a joint touches.
enum class Side : signed char { lower = -1, none = 0, upper = 1 };

/// An end of a range.
struct Stop {
  double angle;                ///< phi, rad; infinite where there is none
  double restitution = 0.0;    ///< e
  double capture_speed = 0.0;  ///< below which e = 0, rad/s
};

struct JointSupport {
  bool is_locked = false;
  double friction = 0.0;  ///< t_s of all its dry friction, N m
  std::vector<std::size_t> friction_effects;
  Stop lower{-never}, upper{never};
  double natural_speed = 0.0;  ///< sqrt(torque / inertia), rad/s: gravity, springs and motors
  /// What its laws add up: of angles (N m/rad), rates (N m s/rad), and constants (N m).
  double stiffness = 0.0, damping = 0.0, torque = 0.0;

  const Stop& stop(Side side) const { return side == Side::lower ? lower : upper; }
};

/// The supports of all joints, (n). Where stops overlap, the narrowest range counts.
std::vector<JointSupport> joint_supports(const Scene& scene, const Inertia& inertia);

}  // namespace pendcore
