/// \file
/// The joints that do not turn: locked, stuck under dry friction, or pushed against a stop.
///
/// A joint at rest is held while the torque lambda that holds it stays within a range: +-t_s from
/// friction, and any torque that pushes away from a stop. One problem for all joints at rest
/// (joint_forces.hpp) decides which of them are held,
///
///     phidd = a + W lambda,    a: the accelerations if nothing held the joints
///
/// This is the same as minimising 1/2 (x - x_0)^T M (x - x_0) + sum t_s |phidd| over accelerations
/// x, where x_0 are the accelerations if nothing held the joints. The torques in the held joints
/// follow from the accelerations with and without the holds,
///
///     lambda_j = sum over i >= j of (M (qdd_held - qdd_free))_i
///
/// An impact is a problem of the same kind (impact_laws.hpp). Source: Brogliato, Nonsmooth
/// Mechanics (2016), chapter 5.
/// Cost: three right-hand sides and O(n^3) for a decision, O(n^3) for an impact, two right-hand
/// sides and O(n^2) for the torques.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "arithmetic/epsilon.hpp"
#include "dynamics/contact/joint_support.hpp"
#include "dynamics/joint_forces.hpp"

namespace pendcore {

struct EquationsOfMotion;
class EffectsOfRun;

/// How a joint is held.
struct Hold {
  bool is_held = false;
  double angle = 0.0;              ///< phi
  double least = 0.0, most = 0.0;  ///< it stays held between these torques
};

/// What a continued run needs to know of a joint, held or not.
struct SavedHold {
  Hold hold;
  double torque_size = 0.0;  ///< HeldJoints::torque_size
};

/// The joints that are held in a run. An object belongs to one run and one thread, like the effects
/// whose joints it holds. Joints are counted from 0.
class HeldJoints {
 public:
  explicit HeldJoints(const Scene& scene);

  /// `look` is called from time to time in long decisions on which joints are held, and may throw.
  void look_up_in_long_work(const std::function<void()>& look) { forces_.problem.look = look; }

  /// Whether the scene has friction or stops, which can hold a joint for a while.
  bool can_hold() const { return can_hold_; }

  /// Sets the direction of time, which decides whether a rate leads into a stop or away from it.
  void set_direction(bool forward) { direction_ = forward ? 1.0 : -1.0; }

  /// Whether a decision or an impact had no finite solution, because the mass matrix is singular in
  /// double precision.
  bool has_failed() const { return has_failed_; }

  const std::vector<JointSupport>& supports() const { return supports_; }
  const std::vector<Hold>& holds() const { return holds_; }
  bool is_held(int joint) const { return holds_[joint].is_held; }
  bool any_held_for_now() const;  ///< by anything but a lock
  /// The inertia, kg m^2, of a link and everything beyond it about the joint: M_ii.
  double inertia(int joint) const { return forces_.inertia.links[joint].diagonal; }
  double natural_speed() const { return natural_speed_; }  ///< the highest of all joints, rad/s
  /// s, the shortest that time resolves at t
  double shortest_moment(double t) const {
    return 64.0 * epsilon * std::max(std::abs(t), 1.0 / natural_speed_);
  }

  /// Locks a joint at an angle from now on, and sets this angle in the state.
  void lock(int joint, double angle, double* q);

  /// Decides at a state which joints at rest are held, and in which direction the others slide.
  /// Joint `held_in_any_case`, if it is at rest, is held whatever the solution of the problem is.
  void choose(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
              int held_in_any_case = -1);

  /// The torques that hold the joints, N m, (n).
  void torques(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
               double* torque);

  /// The sum of the magnitudes of the terms of a joint's torque, N m.
  double torque_size(int joint) const { return size_[joint]; }

  /// The largest rounding error of a torque as a share of its size: thousands of sums enter into
  /// it.
  static constexpr double rounding_of_torque = 1e4 * epsilon;

  /// Whether an acceleration of a joint is no more than the rounding error of its torque.
  bool is_rounding(int joint, double phidd) const {
    return forces_.inertia.links[joint].diagonal * std::abs(phidd) <=
           rounding_of_torque * (size_[joint] + supports_[joint].friction);
  }

  /// Releases a joint, which then slides towards larger (1) or smaller (-1) angles.
  void release(EffectsOfRun& effects, int joint, int direction);

  /// The stop that a joint touches.
  Side contact(int joint, const double* q) const;

  /// How fast a joint that touches a stop moves into it, rad/s; 0 where it touches none.
  double into(int joint, const double* q, const double* qd) const;
  /// The highest rate into a stop among all joints, or 0.
  double fastest_strike(const double* q, const double* qd) const;

  /// Rates (n) in which joints rest that turn by no more than rounding, if something could hold
  /// them: the dense output of a joint that is held is off by it.
  std::vector<double> without_rounding(const double* qd) const;

  /// Begins an impact at these angles, by the laws of impact_laws.hpp.
  void begin_impact(const double* q);
  /// Applies Newton's law of impact, with restitution, to all joints that move into their stops.
  /// Joints at rest at a stop take part if they are held, or all of them if `with_all_at_rest`. If
  /// `is_plastic`, there is no restitution.
  void bounce(const double* q, double* qd, bool is_plastic, bool with_all_at_rest);
  bool has_bounced(int joint) const { return bounced_[joint] != 0; }  ///< in this impact
  /// Captures a joint: it is to stay at its stop.
  void capture(int joint) { captured_[joint] = 1; }
  bool is_captured(int joint) const { return captured_[joint] != 0; }
  /// Stops the captured joints and lets no other joint move into its stop.
  void stay_at_stops(const double* q, double* qd);
  /// The kinetic energy that the links lose in an impact, J, from the rates before and after it.
  double loss(const double* before, const double* after) const;
  /// The work that the drive of the pivot does in an impact, J, from the rates before and after it.
  double work_of_drive(const EquationsOfMotion& equations, double t,
                       const std::vector<double>& before, const double* after) const;

  /// Sets held joints to the angles at which they are held, and to rest. Returns whether it set
  /// any.
  bool settle(double* q, double* qd) const;

  std::vector<SavedHold> saved_state() const;  ///< (n)
  /// Continues from the saved_state() and the has_failed() of an earlier run, and puts its holds
  /// into `effects`.
  void restore(EffectsOfRun& effects, const std::vector<SavedHold>& saved, bool has_failed);

 private:
  bool is_rigid(int joint) const { return !rigid_.empty() && rigid_[joint]; }
  void put_friction(EffectsOfRun& effects, int joint, int mode);
  void hold(EffectsOfRun& effects, int joint, double angle);
  void set_free(EffectsOfRun& effects);
  void solve();
  void set_slack(const EquationsOfMotion& equations, double t, const double* q, const double* qd);
  template <class TakesPart>
  void set_up_impact(const double* q, const double* qd, TakesPart takes_part);
  void solve_impact(const double* q, double* qd);

  int n_;
  /// The locked joints, if the mass matrix were singular without their locks. These are never set
  /// free; the torque of any other lock is an unknown of the problem. Empty if there are none.
  std::vector<bool> rigid_;
  JointForces forces_;
  std::vector<JointSupport> supports_;
  double natural_speed_;
  bool can_hold_;
  double direction_ = 1.0;
  bool has_failed_ = false;
  std::vector<char> captured_, bounced_;
  std::vector<char> bounces_;  ///< whether each row of an impact's problem bounces
  std::vector<Hold> holds_;
  std::vector<double> held_qdd_, free_qdd_, torque_, size_;
};

}  // namespace pendcore
