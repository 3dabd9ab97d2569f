#include "simulate/switching.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "arithmetic/epsilon.hpp"
#include "dynamics/kinematics.hpp"
#include "pendcore/effects/lock.hpp"
#include "simulate/switching_state.hpp"

namespace pendcore {
namespace {

/// The longest step: an eighth of a period of the fastest wave, where a joint is held that the wave
/// could release. With users' functions, of which no period is known, no step is longer than a
/// hundredth of the time in which the fastest joint turns by a radian.
double longest_step_of(const EffectsOfRun& effects, const HeldJoints& joints) {
  constexpr double eighth_turn = 0.785398163397448;
  constexpr double share_under_users = 0.01;
  double longest = never;
  if (!joints.any_held_for_now()) return longest;
  for (int k = 0; k < effects.waves; ++k) {
    longest = std::min(longest, eighth_turn / std::abs(effects.angular_frequency[k]));
  }
  if (!effects.users.empty()) {
    longest = std::min(longest, share_under_users / joints.natural_speed());
  }
  return longest;
}

/// Says what holds every joint for ever, or nothing where something moves or changes with time.
std::string remark_at_rest(const EffectsOfRun& effects, const HeldJoints& joints, const double* y) {
  if (!joints.any_held_for_now()) return {};
  const auto changes = [](const Effect& effect) {
    return !effect->waves().empty() || effect->last_time() < never || effect.info().depends_on_time;
  };
  if (std::ranges::any_of(effects.effects, changes)) return {};
  const int n = static_cast<int>(effects.held.size());
  bool any_stop = false;
  for (int j = 0; j < n; ++j) {
    if (!joints.is_held(j) || y[n + j] != 0.0) return {};
    any_stop |= joints.contact(j, y) != Side::none;
  }
  return any_stop ? "friction and stops hold every joint" : "dry friction holds every joint";
}

/// Stops a joint. The links beyond it get the same change of rate, so that dampers between them act
/// as before.
void stop_with_links_beyond(int joint, double* qd, int n) {
  const double rate = relative(qd, joint + 1);
  set_relative(qd, joint + 1, 0.0);
  for (int i = joint + 1; i < n; ++i) qd[i] -= rate;
}

/// Whether the error of a joint's rate would give a damper in the next joint a torque that the
/// motion does not have.
bool has_strong_damper_beyond(int joint, const double* qd, const HeldJoints& joints) {
  if (joint + 1 == static_cast<int>(joints.supports().size())) return false;
  const JointSupport& next = joints.supports()[joint + 1];
  const double torque = joints.inertia(joint + 1) * next.natural_speed * next.natural_speed;
  return next.damping * std::abs(relative(qd, joint + 1)) > epsilon * torque;
}

}  // namespace

Switching::Switching(const Scene& scene, const EquationsOfMotion& equations,
                     const std::vector<Account>& accounts, StepWatch* watch)
    : scene_(scene),
      equations_(equations),
      watch_(watch),
      n_(static_cast<int>(scene.links.size())),
      joints_(*equations_.held_joints),
      modes_(equations),
      impacts_(equations, modes_, accounts),
      torque_(n_),
      qdd_(n_) {}

bool Switching::begin(double t, double* y, bool forward) {
  std::vector<double> before;
  if (watch_ != nullptr) before.assign(y, y + 2 * static_cast<std::ptrdiff_t>(n_));
  modes_.set_direction(forward);
  modes_.choose_laws(t, y);
  for (const Lock& lock : effects_of<Lock>(scene_)) {
    joints_.lock(lock.joint - 1, lock.angle.value_or(relative(y, lock.joint)), y);
  }
  const bool strikes = joints_.fastest_strike(y, y + n_) > 0.0;
  if (strikes) {
    impacts_.strike(t, y, true);
  } else {
    modes_.choose_held(t, y, -1);
    modes_.choose_sides(t, y);
  }
  collect_guards(y);
  if (watch_ != nullptr) {
    watch_->changes({.t = t,
                     .before = before,
                     .after = {y, before.size()},
                     .jumped = strikes,
                     .at_start = true,
                     .lost_order = false,
                     .forward = forward,
                     .guard = nullptr,
                     .equations = equations_});
  }
  return strikes;
}

void Switching::collect_guards(const double* y) {
  guards_ = joint_guards(equations_, modes_.changes(), y);
  linear_guards_ = static_cast<int>(std::ranges::count_if(guards_, &JointGuard::is_linear));
  longest_step_ = longest_step_of(*equations_.effects, joints_);
  remark_ = remark_at_rest(*equations_.effects, joints_, y);
}

void Switching::step_taken() {
  for (JointGuard& guard : guards_) guard.multiplicity = 0;
}

double Switching::slope_at_rest(int k, double t, const double* y) {
  const JointGuard& guard = guards_[k];
  if (!guard.is_on_rate()) return std::nan("");
  still_.assign(y, y + 2 * static_cast<std::ptrdiff_t>(n_));
  double* const qd = still_.data() + n_;
  stop_with_links_beyond(guard.joint, qd, n_);
  accelerations_in_force(equations_, t, still_.data(), qd, qdd_.data());
  return guard.linear.on_phid * relative(qdd_.data(), guard.joint + 1);
}

double Switching::rounding(int k, const double* y) const {
  const JointGuard& guard = guards_[k];
  return guard.is_linear() ? guard.rounding(y, n_)
                           : last_bits_share * joints_.torque_size(guard.joint);
}

void Switching::other_guards(double t, const double* y, double* values) {
  joints_.torques(equations_, t, y, y + n_, torque_.data());
  for (const JointGuard& guard : std::span(guards_).subspan(linear_guards_)) {
    const Hold& hold = joints_.holds()[guard.joint];
    const double torque = torque_[guard.joint];
    const bool is_most = guard.kind == JointGuard::Kind::most_torque;
    *values++ = is_most ? hold.most - torque : torque - hold.least;
  }
}

bool Switching::settle(int k, double* y) const {
  double* const qd = y + n_;
  bool changed = joints_.settle(y, qd);
  if (k >= 0) {
    const int j = guards_[k].joint;
    const Side stop = guards_[k].stop();
    if (stop != Side::none) {
      set_relative(y, j + 1, joints_.supports()[j].stop(stop).angle);
      changed = true;
    } else if (guards_[k].is_on_rate()) {  // the guard is on the rate alone, which is zero there
      if (has_strong_damper_beyond(j, qd, joints_)) {
        stop_with_links_beyond(j, qd, n_);
      } else {
        set_relative(qd, j + 1, 0.0);
      }
      changed = true;
    }
  }
  // Held joints beyond that joint move with it.
  return (changed && joints_.settle(y, qd)) || changed;
}

bool Switching::cross(int k, double t, double* y) {
  if (watch_ == nullptr) return change(k, t, y);
  const std::vector<double> before(y, y + 2 * static_cast<std::ptrdiff_t>(n_));
  const std::optional<JointGuard> guard = k < 0 ? std::nullopt : std::optional(guards_[k]);
  const bool jumped = change(k, t, y);
  watch_->changes({.t = t,
                   .before = before,
                   .after = {y, before.size()},
                   .jumped = jumped,
                   .at_start = false,
                   .lost_order = impacts_.order().lost == t,
                   .forward = modes_.is_forward(),
                   .guard = guard ? &*guard : nullptr,
                   .equations = equations_});
  return jumped;
}

bool Switching::change(int k, double t, double* y) {
  modes_.begin_change(t);
  bool jumped = false;
  if (k < 0) {
    modes_.cross_time(t);
  } else {
    const JointGuard& guard = guards_[k];
    switch (guard.kind) {
      case JointGuard::Kind::law:
      case JointGuard::Kind::side: modes_.cross_guard(guard.effect, guard.number); break;
      case JointGuard::Kind::friction: come_to_rest(k, t, y); break;
      case JointGuard::Kind::lower_stop:
      case JointGuard::Kind::upper_stop: jumped = reach_stop(k, t, y); break;
      case JointGuard::Kind::least_torque: modes_.release(guard.joint, 1, t, y); break;
      case JointGuard::Kind::most_torque: modes_.release(guard.joint, -1, t, y); break;
    }
  }
  modes_.end_change(jumped, t, y);
  // Otherwise the steps decide: choose_sides() would undo each change.
  if (k >= 0 && !modes_.changes().may_be_rounding()) modes_.choose_sides(t, y);
  collect_guards(y);
  return jumped;
}

/// Lets a joint reach its stop. Returns whether the state jumped.
bool Switching::reach_stop(int k, double t, double* y) {
  settle(k, y);
  const int joint = guards_[k].joint;
  double* const qd = y + n_;
  if (std::abs(relative(qd, joint + 1)) <= epsilon * joints_.supports()[joint].natural_speed) {
    // This is not an impact: an impact would set joints in motion that friction holds, at a rate
    // below all rounding.
    set_relative(qd, joint + 1, 0.0);
    joints_.settle(y, qd);
    modes_.choose_held(t, y, joint);
    return false;
  }
  // A joint that was leaving the stop may be back too soon for time to resolve it: it is captured.
  const std::vector<double> before(qd, qd + n_);
  impacts_.strike(t, y, false);
  return !std::equal(before.begin(), before.end(), qd);
}

void Switching::come_to_rest(int k, double t, double* y) {
  settle(k, y);
  const int joint = guards_[k].joint;
  // If the torques begin to hold the joint just now, rounding must not decide whether they do.
  const bool is_border = joints_.is_rounding(joint, slope_at_rest(k, t, y));
  joints_.choose(equations_, t, y, y + n_,
                 is_border || modes_.changes().seem_endless() ? joint : -1);
}

std::vector<double> Switching::saved_state() const {
  SwitchingState state{.modes = equations_.effects->modes,
                       .changes = modes_.changes(),
                       .impacts = impacts_.order(),
                       .holds = joints_.saved_state(),
                       .has_failed = joints_.has_failed(),
                       .multiplicities = {}};
  for (int k = 0; k < linear_guards_; ++k) state.multiplicities.push_back(guards_[k].multiplicity);
  return numbers_of(std::move(state));
}

void Switching::restore(const std::vector<double>& saved, double t, const double* y, bool forward) {
  modes_.set_direction(forward);
  const SwitchingState state = switching_state(saved, equations_.effects->modes.size(), n_);
  modes_.restore(state.modes, state.changes, t);
  joints_.restore(*equations_.effects, state.holds, state.has_failed);
  impacts_.restore(state.impacts);
  collect_guards(y);
  require_modes_fit(static_cast<int>(state.multiplicities.size()) == linear_guards_);
  for (int k = 0; k < linear_guards_; ++k) guards_[k].multiplicity = state.multiplicities[k];
}

}  // namespace pendcore
