/// \file
/// The modes of a scene's effects along a run: when they change, and to what.
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

#include <cmath>
#include <functional>
#include <limits>

#include "dynamics/contact/held_joints.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "integrate/loop/discontinuities.hpp"

namespace pendcore {

class Switching final : public Discontinuities {
 public:
  /// `accounts` are the accounts of the ledger, which the state has after angles and rates if the
  /// ledger is kept.
  Switching(const Scene& scene, const EquationsOfMotion& equations,
            const std::vector<Account>& accounts);

  bool begin(double t, double* y, bool forward) override;
  double next_time(double t) const override;
  double longest_step() const override { return longest_step_; }
  int guards() const override { return linear_guards() + static_cast<int>(held_guards_.size()); }
  int linear_guards() const override { return static_cast<int>(guards_.size()); }
  int multiplicity_at_start(int k) const override { return guards_[k].multiplicity; }
  void polynomial(int k, const double* rows, int degree, int dimension,
                  double* coefficients) const override;
  double guard(int k, const double* y) const override;
  double slope_at_rest(int k, double t, const double* y) override;
  double rounding(int k, const double* y) const override;
  void other_guards(double t, const double* y, double* values) override;
  bool settles_every_step() const override { return any_held_; }
  bool settle(int k, double* y) const override;
  void step_taken() override;
  bool cross(int k, double t, double* y) override;
  bool is_over() const override { return is_over_ || joints_.has_failed(); }
  bool rests() const override { return rests_; }
  std::vector<double> saved_state() const override;

  /// Replaces begin() in a continued run.
  void restore(const std::vector<double>& memory, double t, const double* y, bool forward);

  /// `look` is called from time to time in long decisions on which joints are held, and may throw.
  void look_up_in_long_work(const std::function<void()>& look) {
    joints_.look_up_in_long_work(look);
  }

  /// The remark of a run that ended at rest, or empty.
  const std::string& remark() const { return remark_; }
  /// The remark of a run in which the order of impacts was lost, or empty.
  std::string remark_on_impacts() const;

 private:
  /// What a guard watches, which says what follows its zero.
  enum class Watched : std::uint8_t {
    law,       ///< an angle or a torque at which a law changes to its next mode
    side,      ///< the rate of a joint, whose sign is the mode of a law
    friction,  ///< the rate of a joint with dry friction, which may come to rest
    lower_stop,
    upper_stop
  };
  struct Watch {
    Watched what;
    int joint;  ///< counted from 0
    Guard guard;
    std::size_t effect = 0;
    std::size_t number = 0;  ///< among the guards of the effect's mode
    int multiplicity = 0;    ///< of its zero at the start of the next step

    bool is_on_rate() const { return what == Watched::side || what == Watched::friction; }
    Side stop() const {
      return what == Watched::lower_stop   ? Side::lower
             : what == Watched::upper_stop ? Side::upper
                                           : Side::none;
    }
  };
  /// A guard on the torque that holds a joint, at one end of its range.
  struct HeldGuard {
    int joint;
    bool is_most;
  };
  /// After many changes at one time, the sign of an acceleration may be nothing but rounding.
  bool may_be_rounding() const { return changes_at_once_ > 8; }
  /// Whether the changes at this time do not end by themselves.
  bool do_not_end() const { return changes_at_once_ > 24; }
  void put_mode(std::size_t i, int mode) { equations_.effects->put_mode(i, mode); }
  /// Chooses the modes from time t on: by the state, and -1 where a table has ended.
  void choose_modes_from(double t, const double* q, const double* qd);
  void choose_sides(double t, const double* q, const double* qd);
  /// The parts of cross(): for a time, and for each kind of guard.
  void cross_time(double t);
  void release(const HeldGuard& guard, double t, const double* y);
  bool reach_stop(int k, double t, double* y);
  void come_to_rest(int k, double t, double* y);
  void stop_joint(int joint, double* qd) const;
  void change_side(const Watch& watch);
  double shortest_moment(double t) const;  ///< s, the shortest that time resolves
  void choose(double t, const double* y, int joint);
  void strike(double t, double* y, bool begins);
  void bounce_in_turn(double t, double* y, bool begins);
  void choose_all_modes(double t, const double* y);
  bool loses_order_of(const double* y);
  bool any_struck_leaves(const double* y) const;
  bool capture(double t, const double* q, const double* qd);
  void count_at_once(double t);
  bool is_at_its_border(int joint, double t, const double* y) const;
  void forget_releases_away_from_the_border(double t, const double* y);
  /// Collects the guards after modes and holds have changed.
  void collect_guards(const double* y);
  void collect_stops();
  int multiplicity_at_start(const Watch& watch, const double* y) const;
  void see_whether_all_rests(const double* y);
  void set_longest_step();
  bool is_for_good() const;
  void book(Account account, double value, double* y) const;

  Scene scene_;
  EquationsOfMotion equations_;
  std::vector<Account> accounts_;
  int n_;
  HeldJoints& joints_;
  bool forward_ = true;
  bool any_held_ = false;
  bool is_over_ = false;  ///< a table or a spline has ended
  bool rests_ = false;
  double longest_step_ = never;
  mutable double next_time_ = 0.0;  ///< the next time after asked_
  mutable double asked_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<Watch> guards_;
  std::vector<HeldGuard> held_guards_;
  std::vector<double> torque_;  ///< the torques that hold the joints
  std::vector<double> still_;   ///< a state in which a joint is at rest
  std::vector<double> qdd_;
  double time_of_change_ = std::numeric_limits<double>::quiet_NaN();
  int changes_at_once_ = 0;
  /// The time of the last impact, and the joints that struck then, or so shortly before that
  /// doubles hardly distinguish the times.
  double time_of_impact_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<int> struck_;
  bool loses_order_ = false;  ///< whether the current impact does
  /// The time at which impacts first came so close together that their order is not known; NaN if
  /// it always was.
  double order_lost_ = std::numeric_limits<double>::quiet_NaN();
  /// Whether the rate of each joint that was held until this time is to rise (1) or fall (-1) from
  /// zero; 0 for all other joints. Only runs forward in time hold joints that can be released.
  std::vector<int> release_direction_;
  std::string remark_;
};

}  // namespace pendcore
