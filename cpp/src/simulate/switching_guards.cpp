// The guards of Switching: which there are, and their values.
#include <cmath>

#include "pendcore/arithmetic/epsilon.hpp"
#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/simulate/switching.hpp"

namespace pendcore {

void Switching::collect_guards(const double* y) {
  any_held_ = equations_.effects->any_held;
  guards_.clear();
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& one) {
          if constexpr (HasModes<Kind> && OnJoint<Kind>) {
            const int joint = one.joint - 1;
            if (!one.has_modes() || equations_.effects->held[joint] != 0) return;
            const std::vector<Guard> guards = one.guards(equations_.effects->modes[i]);
            for (std::size_t k = 0; k < guards.size(); ++k) {
              guards_.push_back({i, k, joint, guards[k], Side::none, 0});
            }
          }
        },
        scene_.effects[i]);
  }
  collect_stops(y);
  held_guards_.clear();
  for (int j = 0; j < n_; ++j) {
    if (!joints_.is_held(j)) continue;
    if (joints_.holds()[j].least > -never) held_guards_.push_back({j, false});
    if (joints_.holds()[j].most < never) held_guards_.push_back({j, true});
  }
  for (Watch& watch : guards_) {
    if (watch.stop != Side::none || !watch.guard.is_on_rate()) continue;
    const bool is_zero = relative(y + n_, watch.joint + 1) == 0.0;
    // A released joint has no acceleration yet. After many changes at one time, the acceleration is
    // taken for rounding.
    const bool accelerates =
        release_direction_[watch.joint] == 0 && changes_at_once_ <= many_at_once;
    watch.zeros_at_start = is_zero ? (accelerates ? 1 : 2) : 0;
  }
  set_longest_step();
  see_whether_all_rests(y);
}

void Switching::collect_stops(const double* y) {
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = joints_.supports()[j];
    if (equations_.effects->held[j] != 0) continue;
    const Side touches = joints_.contact(j, y);
    // The rate and the acceleration of a joint that was held until now are zero too.
    const bool is_doubtful = changes_at_once_ > many_at_once;
    const bool is_still = relative(y + n_, j + 1) == 0.0;
    const int zeros = is_still && (release_direction_[j] != 0 || is_doubtful) ? 3 : 1;
    if (support.lower.angle > -never) {
      const Guard above{.offset = -support.lower.angle, .on_phi = 1.0, .on_phid = 0.0};
      guards_.push_back({0, 0, j, above, Side::lower, touches == Side::lower ? zeros : 0});
    }
    if (support.upper.angle < never) {
      const Guard below{.offset = support.upper.angle, .on_phi = -1.0, .on_phid = 0.0};
      guards_.push_back({0, 0, j, below, Side::upper, touches == Side::upper ? zeros : 0});
    }
  }
}

void Switching::step_taken() {
  for (Watch& watch : guards_) watch.zeros_at_start = 0;
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
  if (watch.stop != Side::none || !watch.guard.is_on_rate()) return std::nan("");
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
    if (watch.stop != Side::none) {
      set_relative(q, j + 1, joints_.supports()[j].stop(watch.stop).angle);
      changed = true;
    } else if (watch.guard.is_on_rate()) {
      stop_joint(j, qd);  // the guard is on the rate alone, which is zero there
      changed = true;
    }
  }
  // Held joints beyond that joint move with it.
  return (changed && joints_.settle(q, qd)) || changed;
}

}  // namespace pendcore
