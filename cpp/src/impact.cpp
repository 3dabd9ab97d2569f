#include "pendcore/dynamics/impact.hpp"

#include <algorithm>
#include <cmath>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/kinematics.hpp"

namespace pendcore {
namespace {

/// Joints that throw each other back may strike for ever at one time, ever more slowly: the last
/// impact leaves all of them at their stops, or leaving.
constexpr int most_at_once = 100;

}  // namespace

bool HeldJoints::strikes(int joint, const double* q, const double* qd) const {
  return static_cast<double>(contact(joint, q)) * relative(qd, joint + 1) * direction_ > 0.0;
}

bool HeldJoints::any_strikes(const double* q, const double* qd) const {
  for (int j = 0; j < n_; ++j) {
    if (strikes(j, q, qd)) return true;
  }
  return false;
}

Impact HeldJoints::strike(const EquationsOfMotion& equations, double t, const double* q, double* qd,
                          bool is_plastic) {
  const std::vector<double> before(qd, qd + n_);
  forces_.set_mass_matrix(q);
  std::ranges::fill(bounced_, 0);
  Impact impact;
  for (int i = 1; i <= most_at_once; ++i) {
    const bool is_last = i == most_at_once;
    impact.loss += strike_once(q, qd, is_plastic || is_last, is_last);
    if (has_failed_ || !any_strikes(q, qd)) break;
  }
  std::vector<double> change(n_);
  for (int i = 0; i < n_; ++i) change[i] = qd[i] - before[i];
  impact.work_of_drive = work_of_drive(equations, t, change.data());
  return impact;
}

/// All joints that do not leave their stops, or all that touch them; what it took of the energy.
double HeldJoints::strike_once(const double* q, double* qd, bool is_plastic, bool all) {
  std::vector<int>& joints = forces_.joints;
  ForcesBetweenBounds& problem = forces_.problem;
  auto into = [&](int j) {  // the stop
    return static_cast<double>(contact(j, q)) * direction_ * relative(qd, j + 1);
  };
  joints.clear();
  for (int j = 0; j < n_; ++j) {
    const bool touches = contact(j, q) != Side::none;
    const bool takes_part = all || is_captured(j) || into(j) >= 0.0;
    if (supports_[j].is_locked || (touches && takes_part)) joints.push_back(j);
  }
  forces_.set_up();
  std::vector<double> before(joints.size());
  for (int r = 0; r < problem.size; ++r) {
    const int j = joints[r];
    const Side side = contact(j, q);
    const Stop& stop = supports_[j].stop(side);
    const bool must_stay = supports_[j].is_locked || is_captured(j);
    const bool bounces = !must_stay && !is_plastic && stop.restitution > 0.0 && into(j) > 0.0 &&
                         into(j) >= stop.capture_speed;
    before[r] = direction_ * relative(qd, j + 1);
    problem.a[r] = before[r] + (bounces ? stop.restitution * before[r] : 0.0);
    problem.lower[r] = must_stay || side == Side::upper ? -never : 0.0;
    problem.upper[r] = must_stay || side == Side::lower ? never : 0.0;
    bounced_[j] = bounces ? 1 : 0;
  }
  solve();
  std::vector<double> change(n_, 0.0);
  forces_.add_response(change.data());
  for (int i = 0; i < n_; ++i) qd[i] += direction_ * change[i];
  double loss = 0.0;
  for (int r = 0; r < problem.size; ++r) {
    const int j = joints[r];
    if (bounced_[j] == 0 && problem.at[r] == Bound::between) set_relative(qd, j + 1, 0.0);
    loss -= 0.5 * problem.lambda[r] * (before[r] + direction_ * relative(qd, j + 1));
  }
  return loss;
}

/// What moves the pivot does work against the impulses at it, J; of a change of the rates.
double HeldJoints::work_of_drive(const EquationsOfMotion& equations, double t,
                                 const double* change) const {
  EffectsInForce& effects = *equations.effects;
  if (effects.pivots.empty()) return 0.0;
  double x, y;
  effects.compute_waves(t, 0);
  effects.pivot_velocity(t, x, y);
  double work = 0.0;
  for (int i = 0; i < n_; ++i) {
    const double moment = forces_.inertia.first_moment[i] * change[i];
    work += moment * (y * forces_.cosine[i] - x * forces_.sine[i]);
  }
  return work;
}

}  // namespace pendcore
