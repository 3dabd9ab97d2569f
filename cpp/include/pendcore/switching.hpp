/// \file
/// The modes of a scene's effects along a run: when they change, and to what.
///
/// Where dynamics and integration meet: the loop sees a Breaks (integrate/breaks.hpp), the laws see
/// the mode that they are frozen to (effects/law.hpp). A locked joint is part of it: its angle and
/// rate are set at the end of each step, so that no rounding lets them wander.
///
/// Dry friction: where the rate of a joint reaches zero, the joint goes on in the other direction
/// if friction of that sign leaves it an acceleration that way; otherwise it sticks.
#pragma once

#include <cmath>
#include <limits>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/integrate/breaks.hpp"

namespace pendcore {

class Switching final : public Breaks {
 public:
  Switching(const Scene& scene, const EquationsOfMotion& equations);

  /// Whether the scene has anything for it to do.
  static bool is_needed(const Scene& scene);

  Status begin(double t, double* y, bool forward) override;
  double next_time(double t) const override;
  int guards() const override { return static_cast<int>(guards_.size()); }
  double guard(int k, const double* y) const override;
  void polynomial(int k, const double* rows, int degree, int dimension,
                  double* coefficients) const override;
  bool settles_every_step() const override { return has_locks_; }
  bool settle(int k, double* y) const override;
  Status cross(int k, double t, const double* y) override;
  std::vector<double> memory() const override;

  /// In place of begin() for a run that goes on.
  void restore(const std::vector<double>& memory, bool forward);

  /// What a run says that ended at rest or stuck; empty if nothing.
  const std::string& remark() const { return remark_; }

 private:
  struct Watch {
    std::size_t effect;
    std::size_t number;  ///< among the guards of the effect's mode
    int joint;           ///< from 1
    Guard guard;
  };
  void put_mode(std::size_t i, int mode) { equations_.effects->put_mode(i, mode); }
  /// The modes that hold from time t on: those of the state, and none where a table has ended.
  void choose_modes_from(double t, const double* q, const double* qd);
  void collect_guards();
  void set_locks(const double* start);
  bool is_locked(int joint) const { return !std::isnan(lock_angle_[joint - 1]); }
  int joint_of(std::size_t effect) const;
  /// The mode of dry friction number i where its joint has no rate: 1, -1, or 0 where it sticks.
  int sliding_mode(std::size_t i, double t, const double* q, const double* qd);
  bool rests(double t, const double* q, const double* qd);
  bool is_for_good() const;
  Status hold_every_joint();

  Scene scene_;
  EquationsOfMotion equations_;
  int n_;
  bool forward_ = true;
  bool has_locks_ = false;
  mutable double next_time_ = 0.0;  ///< after the time asked for last
  mutable double asked_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<Watch> guards_;
  std::vector<double> lock_angle_;  ///< of each joint; NaN where there is no lock
  std::string remark_;
};

}  // namespace pendcore
