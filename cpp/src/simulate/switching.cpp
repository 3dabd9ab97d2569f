#include "simulate/switching.hpp"

#include <algorithm>
#include <utility>

#include "arithmetic/epsilon.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/lock.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/switching_state.hpp"

namespace pendcore {

Switching::Switching(const Scene& scene, const EquationsOfMotion& equations,
                     const std::vector<Account>& accounts)
    : scene_(scene),
      equations_(equations),
      accounts_(accounts),
      n_(static_cast<int>(scene.links.size())),
      joints_(*equations_.held_joints),
      torque_(scene.links.size()),
      struck_(scene.links.size()),
      release_direction_(scene.links.size()) {}

bool Switching::begin(double t, double* y, bool forward) {
  forward_ = forward;
  joints_.set_direction(forward);
  choose_modes_from(t, y, y + n_);
  for (const Lock& lock : effects_of<Lock>(scene_)) {
    joints_.lock(lock.joint - 1, lock.angle.value_or(relative(y, lock.joint)), y);
  }
  const bool strikes = joints_.fastest_strike(y, y + n_) > 0.0;
  if (strikes) {
    strike(t, y, true);
  } else {
    joints_.choose(equations_, t, y, y + n_);
    choose_sides(t, y, y + n_);
  }
  collect_guards(y);
  return strikes;
}

void Switching::choose_modes_from(double t, const double* q, const double* qd) {
  choose_modes(*equations_.effects, t, q, qd, forward_);
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    if (!is_outside_table(*scene_.effects[i], t, forward_)) continue;
    put_mode(i, -1);
    is_over_ = true;
  }
}

/// For joints at rest, chooses the modes of laws that differ on the two sides of the rate zero. A
/// joint that was just released takes the side of its release; any other joint takes the side to
/// which its acceleration leads.
void Switching::choose_sides(double t, const double* q, const double* qd) {
  std::vector<double> qdd;
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene_.effects[i];
    const int joint = effect.joint();
    if (joint == 0 || !effect.has_modes()) continue;
    if (effect.holding_torque()) continue;  // as choose() has decided
    if (relative(qd, joint) != 0.0 || joints_.is_held(joint - 1)) continue;
    const int mode = equations_.effects->modes[i];
    const std::vector<Guard> guards = effect.guards(mode);
    for (std::size_t k = 0; k < guards.size(); ++k) {
      if (!guards[k].is_on_rate()) continue;
      if (qdd.empty()) {
        qdd.resize(n_);
        accelerations_in_force(equations_, t, q, qd, qdd.data());
      }
      const double phidd = relative(qdd.data(), joint);
      const int direction = release_direction_[joint - 1];
      const double way = direction != 0 ? direction : phidd;
      const double slope = guards[k].on_phid * way;
      if ((forward_ ? slope : -slope) < 0.0) put_mode(i, effect.next_mode(mode, k));
    }
  }
}

double Switching::next_time(double t) const {
  const bool is_known = forward_ ? asked_ <= t && t < next_time_ : next_time_ < t && t <= asked_;
  if (is_known) return next_time_;
  asked_ = t;
  next_time_ = forward_ ? never : -never;
  for (const Effect& effect : scene_.effects) {
    const double next = effect->next_time(t, forward_);
    next_time_ = forward_ ? std::min(next_time_, next) : std::max(next_time_, next);
  }
  return next_time_;
}

/// Sets the longest step to an eighth of a period of the fastest wave, where a joint is held that
/// the wave could release. With users' functions, of which no period is known, no step is longer
/// than a hundredth of the time in which the fastest joint turns by a radian.
void Switching::set_longest_step() {
  constexpr double eighth_turn = 0.785398163397448;
  constexpr double share_under_users = 0.01;
  longest_step_ = never;
  if (!joints_.any_held_for_now()) return;
  const EffectsInForce& effects = *equations_.effects;
  for (int k = 0; k < effects.waves; ++k) {
    longest_step_ = std::min(longest_step_, eighth_turn / std::abs(effects.angular_frequency[k]));
  }
  if (!effects.users.empty()) {
    longest_step_ = std::min(longest_step_, share_under_users / joints_.natural_speed());
  }
}

/// Whether a released joint has no acceleration yet, apart from the last bits of its torque and of
/// time. Other changes at the same time may have given it one.
bool Switching::is_at_its_border(int joint, double t, const double* y) const {
  std::vector<double> qdd(n_);
  accelerations_in_force(equations_, t, y, y + n_, qdd.data());
  const double now = relative(qdd.data(), joint + 1);
  if (joints_.is_rounding(joint, now)) return true;
  if (now * release_direction_[joint] > 0.0) return false;
  const double moment = (forward_ ? 1.0 : -1.0) * shortest_moment(t);
  std::vector<double> soon(y, y + 2 * static_cast<std::ptrdiff_t>(n_));
  for (int i = 0; i < n_; ++i) {
    soon[i] += moment * y[n_ + i];
    soon[n_ + i] += moment * qdd[i];
  }
  accelerations_in_force(equations_, t + moment, soon.data(), soon.data() + n_, qdd.data());
  return relative(qdd.data(), joint + 1) * release_direction_[joint] > 0.0;
}

void Switching::forget_releases_away_from_the_border(double t, const double* y) {
  for (int j = 0; j < n_; ++j) {
    if (release_direction_[j] != 0 && !is_at_its_border(j, t, y)) release_direction_[j] = 0;
  }
}

void Switching::count_at_once(double t) {
  changes_at_once_ = t == time_of_change_ ? changes_at_once_ + 1 : 0;
  if (changes_at_once_ == 0) std::ranges::fill(release_direction_, 0);
  time_of_change_ = t;
}

bool Switching::cross(int k, double t, double* y) {
  count_at_once(t);
  if (k < 0) {
    cross_time(t);
    forget_releases_away_from_the_border(t, y);
    collect_guards(y);
    return false;
  }
  bool jumped = false;
  if (k >= linear_guards()) {
    release(held_guards_[k - linear_guards()], t, y);
  } else {
    switch (guards_[k].what) {
      case Watched::law:
      case Watched::side: change_side(guards_[k]); break;
      case Watched::friction: come_to_rest(k, t, y); break;
      case Watched::lower_stop:
      case Watched::upper_stop: jumped = reach_stop(k, t, y); break;
    }
  }
  for (int j = 0; j < n_; ++j) {
    if (jumped || joints_.is_held(j)) release_direction_[j] = 0;
  }
  forget_releases_away_from_the_border(t, y);
  // Otherwise the steps decide: choose_sides() would undo each change.
  if (!may_be_rounding()) choose_sides(t, y, y + n_);
  collect_guards(y);
  return jumped;
}

void Switching::release(const HeldGuard& guard, double t, const double* y) {
  if (may_be_rounding()) return choose(t, y, -1);
  release_direction_[guard.joint] = guard.is_most ? -1 : 1;
  joints_.release(*equations_.effects, guard.joint, release_direction_[guard.joint]);
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
    choose(t, y, joint);
    return false;
  }
  // A joint that was leaving the stop may be back too soon for time to resolve it: it is captured.
  const std::vector<double> before(qd, qd + n_);
  strike(t, y, false);
  return !std::equal(before.begin(), before.end(), qd);
}

void Switching::come_to_rest(int k, double t, double* y) {
  settle(k, y);
  const int joint = guards_[k].joint;
  // If the torques begin to hold the joint just now, rounding must not decide whether they do.
  if (joints_.is_rounding(joint, slope_at_rest(k, t, y))) {
    joints_.choose(equations_, t, y, y + n_, joint);
  } else {
    choose(t, y, joint);
  }
}

/// Changes a law to its next mode.
void Switching::change_side(const Watch& watch) {
  const int mode = equations_.effects->modes[watch.effect];
  put_mode(watch.effect, scene_.effects[watch.effect]->next_mode(mode, watch.number));
}

double Switching::shortest_moment(double t) const {
  return 64.0 * epsilon * std::max(std::abs(t), 1.0 / joints_.natural_speed());
}

/// Chooses which joints are held. After too many changes at one time, the joint that changed last
/// is held in any case.
void Switching::choose(double t, const double* y, int joint) {
  joints_.choose(equations_, t, y, y + n_, do_not_end() ? joint : -1);
}

void Switching::cross_time(double t) {
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene_.effects[i];
    if (!effect.has_modes() || !effect.guards(equations_.effects->modes[i]).empty()) continue;
    const bool is_outside = is_outside_table(effect, t, forward_);
    put_mode(i, is_outside ? -1 : effect.mode_at(t, 0.0, 0.0, forward_));
    is_over_ |= is_outside;
  }
}

/// Whether no effect changes with time, so that what holds the joints now holds them for ever.
bool Switching::is_for_good() const {
  return std::ranges::none_of(scene_.effects, [](const Effect& effect) {
    return !effect->waves().empty() || effect->last_time() < never || effect.info().depends_on_time;
  });
}

void Switching::see_whether_all_rests(const double* y) {
  rests_ = joints_.any_held_for_now() && is_for_good();
  for (int j = 0; j < n_; ++j) rests_ = rests_ && joints_.is_held(j) && y[n_ + j] == 0.0;
  if (!rests_) return;
  bool any_stop = false;
  for (int j = 0; j < n_; ++j) any_stop |= joints_.contact(j, y) != Side::none;
  remark_ = any_stop ? "friction and stops hold every joint" : "dry friction holds every joint";
}

std::vector<double> Switching::saved_state() const {
  SwitchingState state{.modes = equations_.effects->modes,
                       .time_of_change = time_of_change_,
                       .changes_at_once = changes_at_once_,
                       .order_lost = order_lost_,
                       .time_of_impact = time_of_impact_,
                       .struck = struck_,
                       .release_direction = release_direction_,
                       .holds = joints_.saved_state(),
                       .has_failed = joints_.has_failed(),
                       .multiplicities = {}};
  for (const Watch& watch : guards_) state.multiplicities.push_back(watch.multiplicity);
  NumbersWriter io;
  visit(io, state);
  return std::move(io.numbers);
}

void Switching::restore(const std::vector<double>& memory, double t, const double* y,
                        bool forward) {
  forward_ = forward;
  joints_.set_direction(forward);
  const std::size_t joints = scene_.links.size();
  SwitchingState state;
  state.modes.resize(scene_.effects.size());
  state.struck.resize(joints);
  state.release_direction.resize(joints);
  state.holds.resize(joints);
  NumbersReader io(memory);
  visit(io, state);
  for (std::size_t i = 0; i < state.modes.size(); ++i) put_mode(i, state.modes[i]);
  is_over_ = std::ranges::any_of(
      scene_.effects, [&](const Effect& one) { return is_outside_table(*one, t, forward_); });
  joints_.restore(*equations_.effects, state.holds, state.has_failed);
  time_of_change_ = state.time_of_change;
  changes_at_once_ = state.changes_at_once;
  order_lost_ = state.order_lost;
  time_of_impact_ = state.time_of_impact;
  struck_ = state.struck;
  release_direction_ = state.release_direction;
  collect_guards(y);
  require_modes_fit(state.multiplicities.size() == guards_.size());
  for (std::size_t k = 0; k < guards_.size(); ++k) {
    guards_[k].multiplicity = state.multiplicities[k];
  }
}

}  // namespace pendcore
