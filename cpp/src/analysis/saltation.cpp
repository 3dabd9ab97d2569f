#include "analysis/saltation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "dynamics/contact/impact_laws.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "integrate/events/root.hpp"
#include "pendcore/parameters.hpp"

namespace pendcore {
namespace {

/// A change by as little as this would miss an event: of an angle in rad, and of other things as a
/// share of their size.
constexpr double little = 1e-7;

using Kind = JointGuard::Kind;

/// The change of a joint's angle or rate with each name, (k): `rows` are those of q or of qd.
Vector relative_rows(const Matrix& changes, Eigen::Index first, int joint) {
  Vector row = changes.row(first + joint).transpose();
  if (joint > 0) row -= changes.row(first + joint - 1).transpose();
  return row;
}

/// The equations of a scene, with the modes and the holds of a run.
EquationsOfMotion equations_in_force(const Scene& scene, const EquationsOfMotion& run) {
  EquationsOfMotion here = equations_of_motion(scene);
  for (std::size_t i = 0; i < run.effects->modes.size(); ++i) {
    here.effects->put_mode(i, run.effects->modes[i]);
  }
  here.held_joints->restore(*here.effects, run.held_joints->saved_state(), false);
  return here;
}

}  // namespace

Saltation::Saltation(VariationalEquations& equations)
    : equations_(equations),
      n_(equations.links()),
      k_(static_cast<Eigen::Index>(equations.names().size())),
      impact_(equations) {}

std::string Saltation::start(const WatchedChange& change, Matrix& changes) {
  take_laws(change, changes);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto refuse_all = [&](const std::string& why) {
    changes.setConstant(none);
    return "sensitivities: none: " + why;
  };
  if (change.jumped) return refuse_all("the run starts with an impact");
  if (const std::string why = border(change); !why.empty()) return refuse_all(why);
  const HeldJoints& joints = *equations_.equations().held_joints;
  std::string told;
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = joints.supports()[j];
    const Side side = support.is_locked ? Side::none : joints.contact(j, change.after.data());
    const bool is_at_rest = relative(change.after.data() + n_, j + 1) == 0.0;
    // A change of its rate meets another law on either side of rest.
    const bool may_not_turn =
        support.is_locked ||
        (is_at_rest && (side != Side::none || !support.friction_effects.empty()));
    if (!may_not_turn && side == Side::none) continue;
    Vector angles = relative_rows(changes, 0, j);
    const Vector rates = relative_rows(changes, n_, j);
    if (side != Side::none) {
      for (const auto& one : equations_.parameters()) {
        angles[one.column] -= one.supports[j].stop(side).angle;
      }
    }
    for (Eigen::Index column = 0; column < k_; ++column) {
      const bool turns = may_not_turn && rates[column] != 0.0;
      const bool leaves = side != Side::none && angles[column] != 0.0;
      if (!turns && !leaves) continue;
      changes.col(column).setConstant(none);
      told.append(told.empty() ? "sensitivities: none by \"" : ", \"")
          .append(equations_.names()[static_cast<std::size_t>(column)])
          .append("\": " + joint_name(j))
          .append(support.is_locked    ? " is locked, and this would turn it"
                  : side != Side::none ? " is at its stop, and moves from there to one side only"
                                       : " is at rest, where its friction differs to either side");
    }
  }
  return told;
}

std::string Saltation::pass(const WatchedChange& change, Matrix& changes) {
  const Vector f = equations_.rates(change.t, change.before.data());
  Vector f_after(2 * n_);
  f_after.head(n_) = View(change.after.data() + n_, n_);
  accelerations_in_force(change.equations, change.t, change.after.data(), change.after.data() + n_,
                         f_after.data() + n_);
  const HeldJoints& joints = *equations_.equations().held_joints;
  const double natural = joints.natural_speed();
  const double size = std::max({largest(f), largest(f_after), natural * natural});
  const Vector jump = f_after - f;
  const bool is_continuous =
      !change.jumped && (largest(jump) <= rounding_of_rates * size || is_let_go(change, jump));
  const bool is_again =
      std::abs(change.t - last_) <= joints.shortest_moment(change.t) && !follows_the_last(change);
  if (change.guard == nullptr) {
    if (is_again && !was_given_ && !is_continuous) return "two of its laws change at that time";
    last_ = change.t;
    last_jumped_ = false;
    was_given_ = true;
    take_laws(change, changes);
    return border(change);
  }
  const JointGuard guard = *change.guard;
  // What holds a joint takes a jump of the load. It may let the joint go at that given time, and
  // another jump may hold it again before it has moved, whatever the names change.
  const bool is_held_again =
      guard.is_on_rate() && (relative_rows(changes, n_, guard.joint).array() == 0.0).all();
  if (is_again && was_given_ && (is_held_again || !guard.is_linear())) {
    take_laws(change, changes);
    return border(change);
  }
  if (is_continuous) {
    take_laws(change, changes);
    return {};
  }
  if (is_again || meets_a_jump_of_load(change)) return "two of its laws change at that time";
  last_ = change.t;
  last_jumped_ = change.jumped;
  was_given_ = false;

  const std::optional<Crossing> found = crossing(change, f, changes);
  if (!found) return joint_name(guard.joint) + " reaches a law that jumps";
  const bool is_stop = guard.stop() != Side::none;
  if (found->grazes) {
    return joint_name(guard.joint) +
           (is_stop ? " grazes its stop" : " comes to where its law changes, and hardly beyond");
  }

  const Vector shift = found->by_name / -found->slope;
  Matrix after = changes + f * shift.transpose();
  if (change.jumped) {
    if (std::string why = impact_.strike(change, after, remark_); !why.empty()) return why;
    if (change.lost_order) return "stops are struck in an order that rounding decides";
  }
  changes = after - f_after * shift.transpose();
  take_laws(change, changes);
  settle(changes);
  return border(change);
}

std::vector<Saltation::NearMiss> Saltation::near_misses(const WatchedStep& step) {
  const double natural = equations_.equations().held_joints->natural_speed();
  polynomial_.resize(step.degree + 1);
  const double* const rows = step.rows();
  std::vector<NearMiss> found;
  std::vector<TurningPoint> turning_points;
  for (std::size_t i = 0; i < guards_.size(); ++i) {
    const JointGuard& guard = guards_[i];
    guard.polynomial(rows, step.degree, static_cast<int>(step.y.size()), n_, polynomial_.data());
    const double near = guard.is_on_rate() ? little * natural : little;
    double least = polynomial_[0];  // a lower bound
    for (int k = 1; k <= step.degree; ++k) least -= std::abs(polynomial_[k]);
    if (least > near) {
      was_away_[i] = 1;
      continue;
    }
    turning_points.clear();
    // A guard that the last step left near its zero may turn back just between the two.
    if (polynomial_[0] <= near && polynomial_[1] >= 0.0) {
      turning_points.push_back({0.0, polynomial_[0]});
    }
    find_turning_points(polynomial_.data(), step.degree, turning_points);
    for (const auto& [theta, value] : turning_points) {
      if (theta >= step.share) break;
      if (was_away_[i] != 0 && value <= near) found.push_back({theta, &guard});
      was_away_[i] |= value > near ? 1 : 0;
    }
    const double end = polynomial_at(polynomial_.data(), step.degree, step.share);
    was_away_[i] |= end > near ? 1 : 0;
  }
  std::ranges::sort(found, {}, &NearMiss::share);
  return found;
}

std::string Saltation::why_none(const NearMiss& miss, const Matrix& changes) const {
  constexpr double resolved = 1e-6;  // of a change, beside its errors
  const Vector moved = change_of(*miss.guard, changes);
  for (Eigen::Index column = 0; column < k_; ++column) {
    if (!(std::abs(moved[column]) > resolved * largest(changes.col(column)))) continue;
    return joint_name(miss.guard->joint) +
           (miss.guard->is_on_rate() ? " nearly comes to rest" : " grazes its stop");
  }
  return {};
}

/// Whether the load jumps at a given time so near to this one that a slightly different motion
/// would meet both in the other order.
bool Saltation::meets_a_jump_of_load(const WatchedChange& change) const {
  const Scene& scene = equations_.scene();
  const double* const q = change.before.data();
  const double natural = equations_.equations().held_joints->natural_speed();
  const double fastest = std::max(natural, largest(View(q + n_, n_)));
  const double moment = (change.forward ? little : -little) / fastest;
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    if (!effect.has_modes()) continue;
    const double t = effect.next_time(change.t - moment, change.forward);
    if (!(std::abs(t - change.t) <= std::abs(moment))) continue;
    for (const EquationsOfMotion* run : {&equations_.equations(), &change.equations}) {
      const EquationsOfMotion here = equations_in_force(scene, *run);
      const auto accelerations = [&](bool forward) {
        here.effects->put_mode(i, mode_at(effect, t, q, q + n_, forward));
        Vector qdd(n_);
        accelerations_in_force(here, t, q, q + n_, qdd.data());
        return qdd;
      };
      const Vector after = accelerations(change.forward);
      const double jump = largest(after - accelerations(!change.forward));
      if (jump > rounding_of_rates * std::max(largest(after), natural * natural)) return true;
    }
  }
  return false;
}

void Saltation::take_laws(const WatchedChange& change, Matrix& changes) {
  equations_.take_laws(change.t, change.equations, change.forward);
  guards_ = joint_guards(equations_.equations(), {.release_direction = std::vector<int>(n_)},
                         change.after.data());
  std::erase_if(guards_, [](const JointGuard& guard) {
    return guard.kind != Kind::friction && guard.stop() == Side::none;
  });
  was_away_.assign(guards_.size(), 0);
  const std::vector<bool>& corners = equations_.mechanism_along().corners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i]) continue;
    const Eigen::Index column = equations_.parameters()[i].column;
    refuse_name(equations_.names()[static_cast<std::size_t>(column)], change.t, corner_of_a_law,
                column, changes, remark_);
  }
}

/// Whether a joint is let go at the end of the range of torques that hold it, where rates do not
/// jump. Beside a stiff joint, that end is known to a rounding error of many roundings of its own.
bool Saltation::is_let_go(const WatchedChange& change, const Vector& jump) const {
  if (change.guard == nullptr || change.guard->is_linear()) return false;
  const HeldJoints& joints = *equations_.equations().held_joints;
  for (int j = 0; j < n_; ++j) {
    if (!joints.is_rounding(j, relative(jump.data() + n_, j + 1))) return false;
  }
  return true;
}

/// Whether a change that comes at once is no coincidence: friction stops a joint that an impact has
/// set in motion, or the last of many bounces changes next to nothing.
bool Saltation::follows_the_last(const WatchedChange& change) const {
  if (change.guard == nullptr) return false;
  if (change.guard->kind == Kind::friction) return last_jumped_;
  if (change.guard->stop() == Side::none) return false;
  const double rate = relative(change.before.data() + n_, change.guard->joint + 1);
  return std::abs(rate) <= noticeable_rate * equations_.equations().held_joints->natural_speed();
}

/// A joint that is held does not turn, to the last bit.
void Saltation::settle(Matrix& changes) const {
  const HeldJoints& joints = *equations_.equations().held_joints;
  for (int j = 0; j < n_; ++j) {
    if (!joints.is_held(j)) continue;
    if (j > 0) {
      changes.row(n_ + j) = changes.row(n_ + j - 1);
    } else {
      changes.row(n_).setZero();
    }
  }
}

/// The change of a linear guard with each name, (k).
Vector Saltation::change_of(const JointGuard& guard, const Matrix& changes) const {
  const auto& [offset, on_phi, on_phid] = guard.linear;
  Vector change = on_phi * relative_rows(changes, 0, guard.joint) +
                  on_phid * relative_rows(changes, n_, guard.joint);
  if (guard.stop() == Side::none) return change;
  for (const auto& one : equations_.parameters()) {
    change[one.column] -= on_phi * one.supports[guard.joint].stop(guard.stop()).angle;
  }
  return change;
}

std::optional<Saltation::Crossing> Saltation::crossing(const WatchedChange& change, const Vector& f,
                                                       const Matrix& changes) {
  const JointGuard& guard = *change.guard;
  if (guard.kind == Kind::law || !guard.is_linear()) return std::nullopt;
  const int j = guard.joint;
  const auto& [offset, on_phi, on_phid] = guard.linear;
  const double rate = relative(f.data(), j + 1);
  const double acceleration = relative(f.data() + n_, j + 1);
  Crossing found{.by_name = change_of(guard, changes),
                 .slope = on_phi * rate + on_phid * acceleration,
                 .grazes = std::abs(acceleration) <= little * largest(f.tail(n_))};
  if (guard.stop() == Side::none) return found;
  // Without its stop, the joint would turn back after this angle.
  const double beyond = 0.5 * rate * rate / (on_phi * acceleration);
  found.grazes = rate == 0.0 || (beyond > 0.0 && beyond < little);
  return found;
}

/// Whether rounding has decided that a joint is held, or let go.
std::string Saltation::border(const WatchedChange& change) {
  HeldJoints& joints = *equations_.equations().held_joints;
  if (!joints.can_hold()) return {};
  const double* const q = change.after.data();
  const double* const qd = q + n_;
  std::vector<double> torques(n_);
  if (joints.any_held_for_now()) {
    joints.torques(equations_.equations(), change.t, q, qd, torques.data());
  }
  const Vector f = equations_.rates(change.t, q);
  const double size = largest(f.tail(n_));
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = joints.supports()[j];
    if (support.is_locked) continue;
    const Hold& hold = joints.holds()[j];
    // Weight, motors, and springs at this angle, N m: natural_speed counts springs per radian.
    const double acting = joints.inertia(j) * support.natural_speed * support.natural_speed +
                          support.stiffness * (size_of_relative(q, j + 1) - 1.0);
    if (joints.is_held(j)) {
      const double room = std::min(torques[j] - hold.least, hold.most - torques[j]);
      // Far beyond its limit, after a jump of the load, the joint is let go next.
      if (std::abs(room) > rounding_of_rates * std::max(joints.torque_size(j), acting)) continue;
    } else {
      const bool may_be_held =
          !support.friction_effects.empty() || joints.contact(j, q) != Side::none;
      if (!may_be_held || relative(qd, j + 1) != 0.0) continue;
      const bool is_released =
          change.guard != nullptr && change.guard->joint == j && !change.guard->is_linear();
      if (is_released) continue;
      const double torque = joints.inertia(j) * std::abs(relative(f.data() + n_, j + 1));
      if (torque > rounding_of_rates * std::max(joints.inertia(j) * size, acting)) continue;
    }
    return "the torques on " + joint_name(j) + " only just hold it, or only just do not";
  }
  return {};
}

}  // namespace pendcore
