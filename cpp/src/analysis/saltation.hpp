/// \file
/// How small changes of a state go on where the laws of a run change: their saltation.
///
/// At time t*, where a guard g is zero, the rates f- = (qd, qdd) of one law end, the state jumps to
/// R(y), and those of the next law, f+, begin. Changes dy move that time by dt*:
///
///     dt* = -(g_y dy + g_p) / g',   g' = g_y f- + g_t
///     dy+ = R_y (dy + f- dt*) + R_p - f+ dt*
///
/// The guard is the rate of a joint with dry friction, or the angle between a joint and its stop. R
/// is the law of impact (impact_on_changes.hpp).
///
/// Where f+ = f- and R(y) = y, dy goes on as it is: laws whose pieces meet, and a joint that is let
/// go at the end of the range of torques that hold it, as sliding takes the torque that held. At a
/// time that is given, dt* = 0.
///
/// A motion has no such derivative where it grazes a stop, where two of these fall together, and
/// where a joint is held or let go by rounding. There, this refuses in words. So it does
/// where a motion comes as near to that as 1e-7 rad, or as that share of other sizes.
///
/// Sources: Aizerman, Gantmacher, Quarterly Journal of Mechanics and Applied Mathematics 11 (1958)
/// 459; Kong, Payne, Zhu, Johnson, Proceedings of the IEEE 112 (2024) 585.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/impact_on_changes.hpp"
#include "analysis/variational_equations.hpp"
#include "simulate/joint_guards.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

class Saltation {
 public:
  explicit Saltation(VariationalEquations& equations);

  /// Takes the laws with which a run starts. Columns of changes (2n, k) that have no derivative
  /// become NaN. Returns why, or nothing.
  std::string start(const WatchedChange& change, Matrix& changes);
  /// Takes the laws after a change, and brings the changes there. Returns why there are none, or
  /// nothing.
  std::string pass(const WatchedChange& change, Matrix& changes);
  /// A place along a step where a joint's rate or its distance from a stop nearly reaches zero, and
  /// turns back.
  struct NearMiss {
    double share;  ///< of the step
    const JointGuard* guard;
  };
  /// All of them, in their order.
  std::vector<NearMiss> near_misses(const WatchedStep& step);
  /// Says what a slightly different motion would meet there; nothing if none of the changes there
  /// brings it nearer or farther.
  std::string why_none(const NearMiss& miss, const Matrix& changes) const;
  /// Why some names alone have none any more since this was asked last, or nothing.
  std::string take_remark() { return std::exchange(remark_, {}); }

 private:
  /// The change of g with each name, (k), and its slope in time.
  struct Crossing {
    Vector by_name;
    double slope;
    bool grazes;  ///< a slightly different motion would not come there
  };
  Vector change_of(const JointGuard& guard, const Matrix& changes) const;
  std::optional<Crossing> crossing(const WatchedChange& change, const Vector& f,
                                   const Matrix& changes);
  void take_laws(const WatchedChange& change, Matrix& changes);
  bool is_let_go(const WatchedChange& change, const Vector& jump) const;
  bool follows_the_last(const WatchedChange& change) const;
  std::string border(const WatchedChange& change);
  bool meets_a_jump_of_load(const WatchedChange& change) const;
  void settle(Matrix& changes) const;

  VariationalEquations& equations_;
  int n_;
  Eigen::Index k_;
  ImpactOnChanges impact_;
  std::vector<JointGuard> guards_;  ///< of stops and friction, by the laws in force
  std::vector<char> was_away_;      ///< whether each has not been near its zero since these laws
  std::vector<double> polynomial_;  ///< of one of them, along a step
  std::string remark_;
  double last_ = never;       ///< s, when the laws last changed with a jump of rates or state
  bool was_given_ = false;    ///< at a time that no state moves
  bool last_jumped_ = false;  ///< by an impact
};

}  // namespace pendcore
