/// \file
/// The laws of a scene along a run: when they change, to what, and what is set exactly there.
///
/// Dynamics and integration meet here. The loop sees discontinuities
/// (integrate/loop/discontinuities.hpp), the laws see the mode that they are frozen to
/// (effects/behaviour.hpp), and held joints are eliminated from the equations
/// (dynamics/contact/held_joints.hpp). The angles of held joints are set anew at the end of each
/// step, so that rounding does not make them drift.
///
/// * The rate of a joint with dry friction reaches zero: it sticks, or goes on in the other
///   direction, as all joints at rest decide together.
/// * A joint reaches a stop: there is an impact, after which the joint bounces or stays.
/// * The torque that holds a joint leaves its range: the joint is released.
#pragma once

#include <string>
#include <vector>

#include "integrate/loop/discontinuities.hpp"
#include "simulate/impacts.hpp"
#include "simulate/joint_guards.hpp"
#include "simulate/modes.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

class Switching final : public Discontinuities {
 public:
  /// `accounts` are the accounts of the ledger, which the state has after angles and rates if the
  /// ledger is kept. The scene must outlive this object, and so must the watch, which may be null.
  Switching(const Scene& scene, const EquationsOfMotion& equations,
            const std::vector<Account>& accounts, StepWatch* watch = nullptr);
  Switching(const Switching&) = delete;  // the impacts refer to the modes
  Switching& operator=(const Switching&) = delete;

  /// Chooses the laws for a start at time t, and may adjust the state. Returns whether the state
  /// jumped.
  bool begin(double t, double* y, bool forward);
  /// Replaces begin() in a continued run.
  void restore(const std::vector<double>& saved, double t, const double* y, bool forward);

  double next_time(double t) const override { return modes_.next_time(t); }
  double longest_step() const override { return longest_step_; }
  int guards() const override { return static_cast<int>(guards_.size()); }
  int linear_guards() const override { return linear_guards_; }
  int multiplicity_at_start(int k) const override { return guards_[k].multiplicity; }
  void polynomial(int k, const double* rows, int degree, int dimension,
                  double* coefficients) const override {
    guards_[k].polynomial(rows, degree, dimension, n_, coefficients);
  }
  double guard(int k, const double* y) const override { return guards_[k].value(y, n_); }
  double slope_at_rest(int k, double t, const double* y) override;
  double rounding(int k, const double* y) const override;
  void other_guards(double t, const double* y, double* values) override;
  bool settles_every_step() const override { return equations_.effects->any_held; }
  bool settle(int k, double* y) const override;
  void step_taken() override;
  bool cross(int k, double t, double* y) override;
  bool is_over() const override { return modes_.is_over() || joints_.has_failed(); }
  bool rests() const override { return !remark_.empty(); }
  std::vector<double> saved_state() const override;

  /// The remark of a run that ended at rest, or empty.
  const std::string& remark() const { return remark_; }
  /// The remark of a run in which the order of impacts was lost, or empty.
  std::string remark_on_impacts() const { return impacts_.remark(); }

 private:
  bool reach_stop(int k, double t, double* y);
  void come_to_rest(int k, double t, double* y);
  bool change(int k, double t, double* y);
  void collect_guards(const double* y);

  const Scene& scene_;
  EquationsOfMotion equations_;
  StepWatch* watch_;
  int n_;
  HeldJoints& joints_;
  Modes modes_;
  Impacts impacts_;
  std::vector<JointGuard> guards_;
  int linear_guards_ = 0;
  double longest_step_ = never;
  std::string remark_;
  std::vector<double> torque_;  ///< the torques that hold the joints
  std::vector<double> still_;   ///< a state in which a joint is at rest
  std::vector<double> qdd_;
};

}  // namespace pendcore
