#include "simulate/modes.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "simulate/initial_state.hpp"

namespace pendcore {

Modes::Modes(const EquationsOfMotion& equations)
    : equations_(equations),
      effects_(*equations_.effects),
      joints_(*equations_.held_joints),
      n_(static_cast<int>(effects_.held.size())) {
  changes_.release_direction.resize(n_);
}

void Modes::set_direction(bool forward) {
  forward_ = forward;
  joints_.set_direction(forward);
}

void Modes::restore(const std::vector<int>& modes, const ChangesAtOnce& changes, double t) {
  for (std::size_t i = 0; i < modes.size(); ++i) effects_.put_mode(i, modes[i]);
  changes_ = changes;
  end_tables(t);
}

/// Freezes the effects whose tables have ended at time t to the mode -1.
void Modes::end_tables(double t) {
  for (std::size_t i = 0; i < effects_.effects.size(); ++i) {
    if (!is_outside_table(*effects_.effects[i], t, forward_)) continue;
    effects_.put_mode(i, -1);
    is_over_ = true;
  }
}

double Modes::next_time(double t) const {
  const bool is_known = forward_ ? asked_ <= t && t < next_time_ : next_time_ < t && t <= asked_;
  if (is_known) return next_time_;
  asked_ = t;
  next_time_ = forward_ ? never : -never;
  for (const Effect& effect : effects_.effects) {
    const double next = effect->next_time(t, forward_);
    next_time_ = forward_ ? std::min(next_time_, next) : std::max(next_time_, next);
  }
  return next_time_;
}

void Modes::choose_all(double t, const double* y) {
  choose_laws(t, y);
  joints_.choose(equations_, t, y, y + n_);
  choose_sides(t, y);
}

void Modes::choose_laws(double t, const double* y) {
  choose_modes(effects_, t, y, y + n_, forward_);
  end_tables(t);
}

void Modes::choose_sides(double t, const double* y) {
  const double* const qd = y + n_;
  std::vector<double> qdd;
  for (std::size_t i = 0; i < effects_.effects.size(); ++i) {
    const EffectBehaviour& effect = *effects_.effects[i];
    const int joint = effect.joint();
    if (joint == 0 || !effect.has_modes()) continue;
    if (effect.holding_torque()) continue;  // as HeldJoints has decided
    if (relative(qd, joint) != 0.0 || joints_.is_held(joint - 1)) continue;
    const int mode = effects_.modes[i];
    const std::vector<Guard> guards = effect.guards(mode);
    for (std::size_t k = 0; k < guards.size(); ++k) {
      if (!guards[k].is_on_rate()) continue;
      if (qdd.empty()) {
        qdd.resize(n_);
        accelerations_in_force(equations_, t, y, qd, qdd.data());
      }
      const int direction = changes_.release_direction[joint - 1];
      const double way = direction != 0 ? direction : relative(qdd.data(), joint);
      const double slope = guards[k].on_phid * way;
      if ((forward_ ? slope : -slope) < 0.0) {
        effects_.put_mode(i, effect.next_mode(mode, k));
      }
    }
  }
}

void Modes::choose_held(double t, const double* y, int changed_last) {
  joints_.choose(equations_, t, y, y + n_, changes_.seem_endless() ? changed_last : -1);
}

void Modes::begin_change(double t) {
  changes_.further = t == changes_.t ? changes_.further + 1 : 0;
  if (changes_.further == 0) std::ranges::fill(changes_.release_direction, 0);
  changes_.t = t;
}

void Modes::cross_time(double t) {
  for (std::size_t i = 0; i < effects_.effects.size(); ++i) {
    const EffectBehaviour& effect = *effects_.effects[i];
    if (!effect.has_modes() || !effect.guards(effects_.modes[i]).empty()) continue;
    effects_.put_mode(i, effect.mode_at(t, 0.0, 0.0, forward_));
  }
  end_tables(t);
}

void Modes::cross_guard(std::size_t effect, std::size_t guard) {
  effects_.put_mode(effect, effects_.effects[effect]->next_mode(effects_.modes[effect], guard));
}

void Modes::release(int joint, int direction, double t, const double* y) {
  if (changes_.may_be_rounding()) return choose_held(t, y, -1);
  changes_.release_direction[joint] = direction;
  joints_.release(effects_, joint, direction);
}

/// Forgets the releases of joints that are held again or are no longer at the border.
void Modes::end_change(bool jumped, double t, const double* y) {
  for (int j = 0; j < n_; ++j) {
    int& direction = changes_.release_direction[j];
    if (jumped || joints_.is_held(j)) direction = 0;
    if (direction != 0 && !is_at_its_border(j, t, y)) direction = 0;
  }
}

/// Whether a released joint has no acceleration yet, apart from the last bits of its torque and of
/// time. Other changes at the same time may have given it one.
bool Modes::is_at_its_border(int joint, double t, const double* y) const {
  const int direction = changes_.release_direction[joint];
  std::vector<double> qdd(n_);
  accelerations_in_force(equations_, t, y, y + n_, qdd.data());
  const double now = relative(qdd.data(), joint + 1);
  if (joints_.is_rounding(joint, now)) return true;
  if (now * direction > 0.0) return false;
  const double moment = (forward_ ? 1.0 : -1.0) * joints_.shortest_moment(t);
  std::vector<double> soon(y, y + 2 * static_cast<std::ptrdiff_t>(n_));
  for (int i = 0; i < n_; ++i) {
    soon[i] += moment * y[n_ + i];
    soon[n_ + i] += moment * qdd[i];
  }
  accelerations_in_force(equations_, t + moment, soon.data(), soon.data() + n_, qdd.data());
  return relative(qdd.data(), joint + 1) * direction > 0.0;
}

}  // namespace pendcore
