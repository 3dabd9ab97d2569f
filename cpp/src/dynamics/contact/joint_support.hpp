/// \file
/// What can hold the joints of a scene: locks, dry friction, and the stops at the ends of a range.
#pragma once

#include <vector>

#include "dynamics/inertia.hpp"
#include "pendcore/effects/effect.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// Which end of its range a joint touches.
enum class Side : signed char { lower = -1, none = 0, upper = 1 };

/// An end of a range.
struct Stop {
  double angle;                ///< phi, rad; infinite where there is none
  double restitution = 0.0;    ///< e
  double capture_speed = 0.0;  ///< e = 0 below this rate, rad/s
};

struct JointSupport {
  bool is_locked = false;
  double friction = 0.0;  ///< the sum of t_s of its dry friction, N m
  std::vector<std::size_t> friction_effects;
  Stop lower{-never}, upper{never};
  double natural_speed = 0.0;  ///< sqrt(torque / inertia) with gravity, springs, motors; rad/s
  /// Sums of magnitudes over its laws: factors of the angle (N m/rad) and of the rate (N m s/rad),
  /// and constants (N m).
  double stiffness = 0.0, damping = 0.0, torque = 0.0;

  const Stop& stop(Side side) const { return side == Side::lower ? lower : upper; }
};

/// The supports of all joints, (n). Several stops on one joint leave it the intersection of their
/// ranges.
std::vector<JointSupport> joint_supports(const Scene& scene, const Inertia& inertia);

}  // namespace pendcore
