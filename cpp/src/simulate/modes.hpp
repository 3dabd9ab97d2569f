/// \file
/// Which laws are in force from a time on: the mode of each effect, and which joints are held.
#pragma once

#include <limits>
#include <vector>

#include "dynamics/contact/held_joints.hpp"
#include "dynamics/equations_of_motion.hpp"

namespace pendcore {

/// The changes of laws at the time of the last one.
struct ChangesAtOnce {
  double t = std::numeric_limits<double>::quiet_NaN();  ///< s, NaN before the first
  int further = 0;                                      ///< changes at t after the first
  /// (n), whether the rate of a joint that was held until t is to rise (1) or fall (-1) from zero;
  /// 0 for all other joints. Only runs forward in time hold joints that can be released.
  std::vector<int> release_direction;

  /// After many changes, the sign of an acceleration may be nothing but rounding.
  bool may_be_rounding() const { return further > 8; }
  /// Whether the changes seem to go on without end.
  bool seem_endless() const { return further > 24; }
};

/// The modes of the effects and the holds of the joints belong to the equations; this class changes
/// them. States are (q, qd), n numbers each.
class Modes {
 public:
  explicit Modes(const EquationsOfMotion& equations);

  void set_direction(bool forward);
  bool is_forward() const { return forward_; }
  const ChangesAtOnce& changes() const { return changes_; }
  /// Continues a run from the modes and the changes() that another one had at t.
  void restore(const std::vector<int>& modes, const ChangesAtOnce& changes, double t);

  /// Whether a table or a spline has ended.
  bool is_over() const { return is_over_; }
  /// The next time after t at which a law changes, whatever the state; infinite if none.
  double next_time(double t) const;

  /// Chooses everything anew, as at the start of a run or after a jump of the rates.
  void choose_all(double t, const double* y);
  /// Chooses the modes that the state calls for.
  void choose_laws(double t, const double* y);
  /// Chooses, for joints at rest, the modes of laws that differ on the two sides of the rate zero.
  /// A joint that was just released takes the side of its release; any other joint takes the side
  /// to which its acceleration leads.
  void choose_sides(double t, const double* y);
  /// Chooses which joints are held. After too many changes at one time, the joint that changed last
  /// is held in any case.
  void choose_held(double t, const double* y, int changed_last);

  // A change at time t: begin_change(), one of the changes, and end_change().

  void begin_change(double t);
  /// Changes the laws that depend on nothing but time.
  void cross_time(double t);
  /// Changes an effect to the mode beyond a guard of its mode.
  void cross_guard(std::size_t effect, std::size_t guard);
  void release(int joint, int direction, double t, const double* y);
  void end_change(bool jumped, double t, const double* y);

 private:
  void end_tables(double t);
  bool is_at_its_border(int joint, double t, const double* y) const;

  EquationsOfMotion equations_;
  EffectsOfRun& effects_;
  HeldJoints& joints_;
  int n_;
  bool forward_ = true;
  bool is_over_ = false;
  ChangesAtOnce changes_;
  mutable double next_time_ = 0.0;  ///< the next time after asked_
  mutable double asked_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace pendcore
