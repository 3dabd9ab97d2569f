// The impacts of HeldJoints, by the laws of impact_laws.hpp.

#include <algorithm>
#include <cmath>

#include "dynamics/contact/held_joints.hpp"
#include "dynamics/contact/momenta.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/kinematics.hpp"

namespace pendcore {
double HeldJoints::into(int joint, const double* q, const double* qd) const {
  return static_cast<double>(contact(joint, q)) * direction_ * relative(qd, joint + 1);
}

double HeldJoints::fastest_strike(const double* q, const double* qd) const {
  double fastest = 0.0;
  for (int j = 0; j < n_; ++j) fastest = std::max(fastest, into(j, q, qd));
  return fastest;
}

void HeldJoints::begin_impact(const double* q) {
  forces_.set_mass_matrix(q);
  std::ranges::fill(captured_, 0);
  std::ranges::fill(bounced_, 0);
}

/// Sets up a row of the problem for each joint that is locked or takes part: its rate without
/// impulses, and the range of impulses that its stop can give.
template <class TakesPart>
void HeldJoints::set_up_impact(const double* q, const double* qd, TakesPart takes_part) {
  std::vector<int>& joints = forces_.joints;
  ForcesBetweenBounds& problem = forces_.problem;
  joints.clear();
  for (int j = 0; j < n_; ++j) {
    const bool touches = contact(j, q) != Side::none;
    if (is_rigid(j)) continue;
    if (supports_[j].is_locked || (touches && takes_part(j))) joints.push_back(j);
  }
  forces_.set_up();
  for (int r = 0; r < problem.size; ++r) {
    const int j = joints[r];
    const Side side = contact(j, q);
    const bool must_stay = supports_[j].is_locked || is_captured(j);
    problem.a(r) = direction_ * relative(qd, j + 1);
    problem.lower(r) = must_stay || side == Side::upper ? -never : 0.0;
    problem.upper(r) = must_stay || side == Side::lower ? never : 0.0;
  }
}

/// Computes the impulses and the rates after them. A rate is exactly zero where a joint is stopped,
/// and where rounding would leave it moving into its stop.
void HeldJoints::solve_impact(const double* q, double* qd) {
  const ForcesBetweenBounds& problem = forces_.problem;
  solve();
  if (has_failed_) return;
  Eigen::Map<Vector>(qd, n_) += direction_ * forces_.refined_response();
  for (int r = 0; r < problem.size; ++r) {
    const int j = forces_.joints[r];
    const bool stops = bounces_[r] == 0 && problem.at[r] == Bound::between;
    if (stops || into(j, q, qd) > 0.0) set_relative(qd, j + 1, 0.0);
  }
}

void HeldJoints::bounce(const double* q, double* qd, bool is_plastic, bool with_all_at_rest) {
  set_up_impact(q, qd, [&](int j) {
    const double speed = into(j, q, qd);
    return speed > 0.0 || (speed == 0.0 && (with_all_at_rest || is_held(j)));
  });
  ForcesBetweenBounds& problem = forces_.problem;
  bounces_.assign(forces_.joints.size(), 0);
  for (int r = 0; r < problem.size; ++r) {
    const int j = forces_.joints[r];
    const Stop& stop = supports_[j].stop(contact(j, q));
    const double speed = into(j, q, qd);
    const bool bounces = !supports_[j].is_locked && !is_plastic && stop.restitution > 0.0 &&
                         speed > 0.0 && speed >= stop.capture_speed;
    bounced_[j] = bounces_[r] = bounces ? 1 : 0;
    // The problem is then one for w+ + e w- instead of w+.
    if (bounces) problem.a(r) += stop.restitution * problem.a(r);
  }
  solve_impact(q, qd);
}

void HeldJoints::stay_at_stops(const double* q, double* qd) {
  set_up_impact(q, qd, [](int) { return true; });
  bounces_.assign(forces_.joints.size(), 0);
  solve_impact(q, qd);
}

double HeldJoints::loss(const double* before, const double* after) const {
  const auto twice = [this](const double* qd) {
    return twice_the_energy(
        momenta(forces_.links, forces_.inertia, forces_.sine, forces_.cosine, qd), qd);
  };
  const double lost = 0.5 * (twice(before) + twice(after) * -1.0).high;
  return std::max(lost, 0.0);  // the rounding of the rates may make it negative
}

double HeldJoints::work_of_drive(const EquationsOfMotion& equations, double t,
                                 const std::vector<double>& before, const double* after) const {
  EffectsOfRun& effects = *equations.effects;
  if (effects.pivots.empty()) return 0.0;
  double x, y;
  effects.compute_waves(t, 0);
  effects.pivot_velocity(t, x, y);
  double work = 0.0;
  for (int i = 0; i < n_; ++i) {
    const double moment = forces_.inertia.links[i].first_moment * (after[i] - before[i]);
    work += moment * (y * forces_.cosine[i] - x * forces_.sine[i]);
  }
  return work;
}

}  // namespace pendcore
