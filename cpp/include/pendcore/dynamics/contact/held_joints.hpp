/// \file
/// The joints that do not turn: locked, stuck under dry friction, or pushed against a stop.
///
/// A joint at rest is held while the torque lambda that this takes stays within a range: +-t_s of
/// friction, and what a stop can push without end. Which joints that are comes out of one problem
/// over all that are at rest (joint_forces.hpp),
///
///     phidd = a + W lambda,    a: what they would do if nothing held them
///
/// the same as minimising 1/2 (x - x_0)^T M (x - x_0) + sum t_s |phidd| over accelerations x. The
/// torques of the joints that are held follow from the right-hand sides with them and without,
///
///     lambda_j = sum over i >= j of (M (qdd_held - qdd_free))_i
///
/// An impact is such a problem too: impact.hpp.
/// Source: Brogliato, Nonsmooth Mechanics (2016), chapter 5.
/// Cost of a decision or an impact: a right-hand side and O(n^3); of the torques: two and O(n^2).
#pragma once

#include <cmath>
#include <functional>

#include "pendcore/arithmetic/epsilon.hpp"
#include "pendcore/dynamics/contact/joint_support.hpp"
#include "pendcore/dynamics/joint_forces.hpp"

namespace pendcore {

struct EquationsOfMotion;
class EffectsInForce;

/// How a joint is held.
struct Hold {
  bool is_held = false;
  double angle = 0.0;              ///< phi
  double least = 0.0, most = 0.0;  ///< the torques between which it stays held
};

/// What a run that goes on needs of a joint, held or not.
struct SavedHold {
  Hold hold;
  double torque_size = 0.0;  ///< HeldJoints::torque_size
};

/// Belongs to one run and one thread, as the effects whose joints it holds. Joints count from 0.
class HeldJoints {
 public:
  explicit HeldJoints(const Scene& scene);

  void look_up_in_long_work(const std::function<void()>& look) { forces_.problem.look = look; }

  /// Whether the scene has friction or stops, that can hold a joint for a while.
  bool can_hold() const { return can_hold_; }

  /// Which way time runs: what moves into a stop is another matter backward.
  void set_direction(bool forward) { direction_ = forward ? 1.0 : -1.0; }

  /// A decision or an impact had no finite answer: the mass matrix is singular to double precision.
  bool has_failed() const { return has_failed_; }

  const std::vector<JointSupport>& supports() const { return supports_; }
  const std::vector<Hold>& holds() const { return holds_; }
  bool is_held(int joint) const { return holds_[joint].is_held; }
  bool any_held_for_now() const;  ///< by other than a lock
  /// The inertia of each link with all that hangs on it, at its joint, kg m^2, (n).
  const std::vector<double>& inertia() const { return forces_.inertia.diagonal; }
  double natural_speed() const { return natural_speed_; }  ///< rad/s, of the fastest joint

  /// A lock: at that angle from now on, in the state too.
  void lock(int joint, double angle, double* q);

  /// At a state: which joints at rest are held, and which way the others slide. Joint `surely`, if
  /// at rest, is held whatever the problem says.
  void choose(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
              int surely = -1);

  /// The torques that hold the joints, N m, (n).
  void torques(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
               double* torque);

  /// The size of what the torque of a joint was added up from, N m.
  double torque_size(int joint) const { return size_[joint]; }

  /// What share of the size of a torque its rounding is at most: thousands of sums enter into it.
  static constexpr double rounding_of_torque = 1e4 * epsilon;

  /// Whether an acceleration of a joint is no more than the rounding of its torque.
  bool is_rounding(int joint, double phidd) const {
    return forces_.inertia.diagonal[joint] * std::abs(phidd) <=
           rounding_of_torque * (size_[joint] + supports_[joint].friction);
  }

  /// Lets a joint go, to slide up or down its angle (1 or -1).
  void release(EffectsInForce& effects, int joint, int direction);

  /// The stop that a joint touches.
  Side contact(int joint, const double* q) const;

  /// How fast a joint that touches a stop moves into it, rad/s; 0 where it touches none.
  double into(int joint, const double* q, const double* qd) const;
  /// The fastest of those that do, or 0.
  double fastest_strike(const double* q, const double* qd) const;

  /// An impact at these angles, by the laws of impact.hpp.
  void begin_impact(const double* q);
  /// Newton's law for all joints that do not leave their stops; what it took of the energy. Joints
  /// at rest there take part if they are held, or all. Without restitution if `is_plastic`.
  double bounce(const double* q, double* qd, bool is_plastic, bool with_all_at_rest);
  bool has_bounced(int joint) const { return bounced_[joint] != 0; }  ///< in this impact
  /// A joint that leaves its stop is to stay there.
  void capture(int joint) { captured_[joint] = 1; }
  bool is_captured(int joint) const { return captured_[joint] != 0; }
  /// Joints that are captured stop, no other moves into its stop; what that took of the energy.
  double stay_at_stops(const double* q, double* qd);
  /// What moves the pivot does work against the impulses at it, J, as the rates change.
  double work_of_drive(const EquationsOfMotion& equations, double t,
                       const std::vector<double>& before, const double* after) const;

  /// Puts held joints exactly where they are held. Whether that changed something.
  bool settle(double* q, double* qd) const;

  std::vector<SavedHold> saved_state() const;  ///< (n)
  void restore(EffectsInForce& effects, const std::vector<SavedHold>& saved);

 private:
  void put_friction(EffectsInForce& effects, int joint, int mode);
  void hold(EffectsInForce& effects, int joint, double angle);
  void set_free(EffectsInForce& effects);
  void solve();
  void set_slack(const EquationsOfMotion& equations, double t, const double* q, const double* qd);
  template <class TakesPart>
  void set_up_impact(const double* q, const double* qd, TakesPart takes_part);
  double solve_impact(const std::vector<double>& before, const double* q, double* qd);

  int n_;
  JointForces forces_;
  std::vector<JointSupport> supports_;
  double natural_speed_;
  bool can_hold_;
  double direction_ = 1.0;
  bool has_failed_ = false;
  std::vector<char> captured_, bounced_;
  std::vector<char> bounces_;  ///< of each row of the problem of an impact
  std::vector<Hold> holds_;
  std::vector<double> held_qdd_, free_qdd_, torque_, size_;
};

}  // namespace pendcore
