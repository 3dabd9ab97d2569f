// The guards of Switching: which there are, and their values.
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "dynamics/kinematics.hpp"
#include "simulate/switching.hpp"

namespace pendcore {

void Switching::collect_guards(const double* y) {
  any_held_ = equations_.effects->any_held;
  guards_.clear();
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene_.effects[i];
    const int joint = effect.joint() - 1;
    if (joint < 0 || !effect.has_modes() || equations_.effects->held[joint] != 0) continue;
    const std::vector<Guard> guards = effect.guards(equations_.effects->modes[i]);
    const bool has_friction = !joints_.supports()[joint].friction_effects.empty();
    for (std::size_t k = 0; k < guards.size(); ++k) {
      const Watched what = !guards[k].is_on_rate() ? Watched::law
                           : has_friction          ? Watched::friction
                                                   : Watched::side;
      guards_.push_back({what, joint, guards[k], i, k});
    }
  }
  collect_stops();
  held_guards_.clear();
  for (int j = 0; j < n_; ++j) {
    if (!joints_.is_held(j)) continue;
    if (joints_.holds()[j].least > -never) held_guards_.push_back({j, false});
    if (joints_.holds()[j].most < never) held_guards_.push_back({j, true});
  }
  for (Watch& watch : guards_) watch.multiplicity = multiplicity_at_start(watch, y);
  set_longest_step();
  see_whether_all_rests(y);
}

void Switching::collect_stops() {
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = joints_.supports()[j];
    if (equations_.effects->held[j] != 0) continue;
    if (support.lower.angle > -never) {
      guards_.push_back({Watched::lower_stop, j, {.offset = -support.lower.angle, .on_phi = 1.0}});
    }
    if (support.upper.angle < never) {
      guards_.push_back({Watched::upper_stop, j, {.offset = support.upper.angle, .on_phi = -1.0}});
    }
  }
}

/// How many of a guard's value, slope and curvature are zero where the next step starts. A joint
/// that was held until now has neither a rate nor an acceleration yet.
int Switching::multiplicity_at_start(const Watch& watch, const double* y) const {
  const int j = watch.joint;
  const bool is_still = relative(y + n_, j + 1) == 0.0;
  const bool was_held = release_direction_[j] != 0 || may_be_rounding();
  switch (watch.what) {
    case Watched::law: return 0;
    case Watched::side:
    case Watched::friction: return !is_still ? 0 : was_held ? 2 : 1;
    case Watched::lower_stop:
    case Watched::upper_stop:
      if (joints_.contact(j, y) != watch.stop()) return 0;
      return is_still && was_held ? 3 : 1;
  }
  return 0;
}

void Switching::step_taken() {
  for (Watch& watch : guards_) watch.multiplicity = 0;
}

double Switching::guard(int k, const double* y) const {
  const Guard& g = guards_[k].guard;
  const int joint = guards_[k].joint + 1;
  return g.offset + g.on_phi * relative(y, joint) + g.on_phid * relative(y + n_, joint);
}

/// The links beyond the joint get the same change of rate, so that dampers between them act as
/// before.
double Switching::slope_at_rest(int k, double t, const double* y) {
  if (k >= linear_guards()) return std::nan("");
  const Watch& watch = guards_[k];
  if (!watch.is_on_rate()) return std::nan("");
  still_.assign(y, y + 2 * static_cast<std::ptrdiff_t>(n_));
  qdd_.resize(n_);
  double* const qd = still_.data() + n_;
  const double rate = relative(qd, watch.joint + 1);
  set_relative(qd, watch.joint + 1, 0.0);
  for (int i = watch.joint + 1; i < n_; ++i) qd[i] -= rate;
  accelerations_in_force(equations_, t, still_.data(), qd, qdd_.data());
  return watch.guard.on_phid * relative(qdd_.data(), watch.joint + 1);
}

double Switching::rounding(int k, const double* y) const {
  if (k >= linear_guards())
    return last_bits_share * joints_.torque_size(held_guards_[k - linear_guards()].joint);
  const auto& [offset, on_phi, on_phid] = guards_[k].guard;
  const int j = guards_[k].joint;
  auto size = [j](const double* x) { return std::abs(x[j]) + (j > 0 ? std::abs(x[j - 1]) : 0.0); };
  return last_bits_share *
         (std::abs(offset) + std::abs(on_phi) * size(y) + std::abs(on_phid) * size(y + n_));
}

void Switching::polynomial(int k, const double* rows, int degree, int dimension,
                           double* coefficients) const {
  const Guard g = guards_[k].guard;
  const int joint = guards_[k].joint + 1;
  for (int p = 0; p <= degree; ++p, rows += dimension) {
    coefficients[p] = g.on_phi * relative(rows, joint) + g.on_phid * relative(rows + n_, joint);
  }
  coefficients[0] += g.offset;
}

void Switching::other_guards(double t, const double* y, double* values) {
  joints_.torques(equations_, t, y, y + n_, torque_.data());
  for (const auto& [joint, is_most] : held_guards_) {
    const Hold& hold = joints_.holds()[joint];
    *values++ = is_most ? hold.most - torque_[joint] : torque_[joint] - hold.least;
  }
}

/// Stops a joint. If the next joint has a strong damper, the links beyond get the same change of
/// rate: otherwise the error of the rate would give that damper a torque that the motion does not
/// have.
void Switching::stop_joint(int joint, double* qd) const {
  const double rate = relative(qd, joint + 1);
  set_relative(qd, joint + 1, 0.0);
  if (joint + 1 == n_) return;
  const JointSupport& next = joints_.supports()[joint + 1];
  const double torque = joints_.inertia(joint + 1) * next.natural_speed * next.natural_speed;
  if (next.damping * std::abs(rate) <= epsilon * torque) return;
  for (int i = joint + 1; i < n_; ++i) qd[i] -= rate;
}

bool Switching::settle(int k, double* y) const {
  double* const q = y;
  double* const qd = y + n_;
  bool changed = joints_.settle(q, qd);
  if (k >= 0 && k < linear_guards()) {
    const Watch& watch = guards_[k];
    const int j = watch.joint;
    if (watch.stop() != Side::none) {
      set_relative(q, j + 1, joints_.supports()[j].stop(watch.stop()).angle);
      changed = true;
    } else if (watch.is_on_rate()) {
      stop_joint(j, qd);  // the guard is on the rate alone, which is zero there
      changed = true;
    }
  }
  // Held joints beyond that joint move with it.
  return (changed && joints_.settle(q, qd)) || changed;
}

}  // namespace pendcore
