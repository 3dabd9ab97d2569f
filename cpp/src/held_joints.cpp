#include "pendcore/dynamics/held_joints.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/kinematics.hpp"

namespace pendcore {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The size of the torques that an effect can exert on a joint that it acts on, N m.
double torque_scale(const Effect& effect) {
  return std::visit(
      [](const auto& one) {
        double scale = 0.0;
        if constexpr (requires { one.couple(0); }) {
          if (const auto couple = one.couple(0)) {
            scale = std::abs(couple->held) + std::abs(couple->on_phi) + std::abs(couple->gain);
          }
        }
        return std::isfinite(scale) ? scale : 0.0;
      },
      effect);
}

/// sqrt(torque / inertia) of each joint: gravity, springs and motors.
std::vector<double> natural_speeds(const Scene& scene, const Inertia& inertia) {
  const std::size_t n = scene.links.size();
  std::vector<double> torque(n);
  for (std::size_t j = 0; j < n; ++j) torque[j] = inertia.first_moment[j] * std::abs(scene.gravity);
  for (const Effect& effect : scene.effects) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.joint; }) torque[one.joint - 1] += torque_scale(effect);
        },
        effect);
  }
  double largest = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    torque[j] = std::sqrt(torque[j] / inertia.diagonal[j]);
    largest = std::max(largest, torque[j]);
  }
  if (largest == 0.0) largest = 1.0;  // nothing drives the joints: 1 rad/s
  for (double& speed : torque) speed = speed > 0.0 ? speed : largest;
  return torque;
}

std::vector<JointSupport> supports_of(const Scene& scene, const std::vector<double>& natural) {
  std::vector<JointSupport> supports(scene.links.size());
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const Effect& effect = scene.effects[i];
    if (const auto* lock = std::get_if<Lock>(&effect)) supports[lock->joint - 1].is_locked = true;
    if (const auto torque = holding_torque(effect)) {
      std::visit(
          [&](const auto& one) {
            if constexpr (requires { one.joint; }) {
              supports[one.joint - 1].friction += *torque;
              supports[one.joint - 1].friction_effects.push_back(i);
            }
          },
          effect);
    }
    if (const auto* stop = std::get_if<JointStop>(&effect)) {
      JointSupport& joint = supports[stop->joint - 1];
      const double capture = stop->capture_speed.value_or(1e-9 * natural[stop->joint - 1]);
      if (stop->range[0] > joint.lower) {
        joint.lower = stop->range[0];
        joint.restitution_lower = stop->restitution;
        joint.capture_lower = capture;
      }
      if (stop->range[1] < joint.upper) {
        joint.upper = stop->range[1];
        joint.restitution_upper = stop->restitution;
        joint.capture_upper = capture;
      }
    }
  }
  return supports;
}

}  // namespace

HeldJoints::HeldJoints(const Scene& scene)
    : n_(static_cast<int>(scene.links.size())),
      inertia_(scene),
      captured_(scene.links.size()),
      bounced_(scene.links.size()),
      holds_(scene.links.size()),
      mass_(scene.links.size() * scene.links.size()) {
  const std::vector<double> natural = natural_speeds(scene, inertia_);
  natural_speed_ = std::ranges::max(natural);
  supports_ = supports_of(scene, natural);
  can_hold_ = std::ranges::any_of(scene.effects, [](const Effect& effect) {
    return holding_torque(effect) || std::holds_alternative<JointStop>(effect);
  });
  for (std::vector<double>* row : {&sine_, &cosine_, &held_qdd_, &free_qdd_, &torque_, &size_}) {
    row->assign(scene.links.size(), 0.0);
  }
}

bool HeldJoints::any_held_for_now() const {
  for (int j = 0; j < n_; ++j) {
    if (is_held(j) && !supports_[j].is_locked) return true;
  }
  return false;
}

void HeldJoints::put_friction(EffectsInForce& effects, int joint, int mode) {
  for (const std::size_t i : supports_[joint].friction_effects) effects.put_mode(i, mode);
}

void HeldJoints::hold(EffectsInForce& effects, int joint, double angle) {
  holds_[joint] = {.is_held = 1.0, .angle = angle, .least = -never, .most = never};
  put_friction(effects, joint, 0);
  effects.hold(joint, true);
}

void HeldJoints::lock(int joint, double angle, double* q) {
  holds_[joint] = {.is_held = 1.0, .angle = angle, .least = -never, .most = never};
  q[joint] = joint > 0 ? q[joint - 1] + angle : angle;
}

void HeldJoints::set_free(EffectsInForce& effects) {
  for (int j = 0; j < n_; ++j) effects.hold(j, false);
}

void HeldJoints::release(EffectsInForce& effects, int joint, int direction) {
  holds_[joint] = Hold{};
  effects.hold(joint, false);
  put_friction(effects, joint, direction);
}

/// The range of a joint ends within the last bits of its angle.
Side HeldJoints::contact(int joint, const double* q) const {
  const double phi = relative(q, joint + 1);
  const double size = std::abs(q[joint]) + (joint > 0 ? std::abs(q[joint - 1]) : 0.0);
  const JointSupport& support = supports_[joint];
  auto is_at = [&](double bound, double distance) {
    return std::isfinite(bound) && distance <= 4.0 * epsilon * (size + std::abs(bound));
  };
  if (is_at(support.lower, phi - support.lower)) return Side::lower;
  if (is_at(support.upper, support.upper - phi)) return Side::upper;
  return Side::none;
}

double HeldJoints::capture_speed(int joint, const double* q) const {
  const JointSupport& support = supports_[joint];
  return contact(joint, q) == Side::lower ? support.capture_lower : support.capture_upper;
}

bool HeldJoints::strikes(int joint, const double* q, const double* qd) const {
  return static_cast<double>(contact(joint, q)) * speed(qd, joint) * direction_ > 0.0;
}

void HeldJoints::fill_mass_matrix(const double* q) {
  sine_cosine(q, n_, sine_.data(), cosine_.data());
  for (int i = 0; i < n_; ++i) {
    double* const row = mass_.data() + static_cast<std::ptrdiff_t>(i) * n_;
    row[i] = inertia_.diagonal[i];
    for (int j = 0; j < i; ++j) {
      const double cosine = cosine_[i] * cosine_[j] + sine_[i] * sine_[j];
      const double of_rotor = j + 1 == i ? inertia_.rotor[i] : 0.0;
      row[j] = mass_[static_cast<std::ptrdiff_t>(j) * n_ + i] =
          inertia_.coupling(i, j) * cosine - of_rotor;
    }
  }
}

/// W of the rows, and what an impulse in each of them does to the rates.
void HeldJoints::fill_responses() {
  factor_ = mass_;
  factor_cholesky(n_, factor_.data());
  const int m = static_cast<int>(rows_.size());
  response_.assign(rows_.size() * static_cast<std::size_t>(n_), 0.0);
  for (int r = 0; r < m; ++r) {
    double* const x = response_.data() + static_cast<std::ptrdiff_t>(r) * n_;
    x[rows_[r]] = 1.0;
    if (rows_[r] > 0) x[rows_[r] - 1] = -1.0;
    solve_lower(n_, factor_.data(), x);
    for (int s = 0; s <= r; ++s) {
      const double* const y = response_.data() + static_cast<std::ptrdiff_t>(s) * n_;
      double sum = 0.0;
      for (int i = 0; i < n_; ++i) sum += x[i] * y[i];
      problem_.W[static_cast<std::size_t>(r) * m + s] = sum;
      problem_.W[static_cast<std::size_t>(s) * m + r] = sum;
    }
  }
}

void HeldJoints::solve() {
  problem_.solve();
  for (const double force : problem_.lambda) has_failed_ |= !std::isfinite(force);
}

void HeldJoints::choose(const EquationsOfMotion& equations, double t, const double* q,
                        const double* qd, int surely) {
  EffectsInForce& effects = *equations.effects;
  rows_.clear();
  bool any = false;
  for (int j = 0; j < n_; ++j) {
    const JointSupport& support = supports_[j];
    const double rate = speed(qd, j);
    const bool is_at_rest =
        rate == 0.0 && (!support.friction_effects.empty() || contact(j, q) != Side::none);
    any |= is_at_rest && !support.is_locked;
    if (support.is_locked || is_at_rest) rows_.push_back(j);
    if (!support.is_locked) holds_[j] = Hold{};
    put_friction(effects, j, is_at_rest || support.is_locked ? 0 : rate < 0.0 ? -1 : 1);
  }
  set_free(effects);
  if (any) {
    accelerations_in_force(equations, t, q, qd, free_qdd_.data());
    fill_mass_matrix(q);
    problem_.resize(static_cast<int>(rows_.size()));
    fill_responses();
    for (int r = 0; r < problem_.size; ++r) {
      const int j = rows_[r];
      const bool is_locked = supports_[j].is_locked;
      const Side side = contact(j, q);
      problem_.a[r] = relative(free_qdd_.data(), j + 1);
      problem_.lower[r] = is_locked || side == Side::upper ? -never : -supports_[j].friction;
      problem_.upper[r] = is_locked || side == Side::lower ? never : supports_[j].friction;
    }
    solve();
  }
  for (int r = 0; r < static_cast<int>(rows_.size()); ++r) {
    const int j = rows_[r];
    const double angle = supports_[j].is_locked ? holds_[j].angle : relative(q, j + 1);
    if (supports_[j].is_locked || problem_.at[r] == Bound::between || j == surely) {
      hold(effects, j, angle);
    } else {
      put_friction(effects, j, problem_.at[r] == Bound::lower ? 1 : -1);
    }
  }
  if (any) set_slack(equations, t, q, qd);
}

/// The torques at which the joints are let go: a rounding beyond their range, so that a joint that
/// is held is not let go by the next evaluation of the same torque.
void HeldJoints::set_slack(const EquationsOfMotion& equations, double t, const double* q,
                           const double* qd) {
  torques(equations, t, q, qd, torque_.data());
  for (int r = 0; r < problem_.size; ++r) {
    const int j = rows_[r];
    if (!is_held(j) || supports_[j].is_locked) continue;
    const double slack = 64.0 * epsilon * (size_[j] + supports_[j].friction);
    holds_[j].least = std::min(problem_.lower[r], torque_[j]) - slack;
    holds_[j].most = std::max(problem_.upper[r], torque_[j]) + slack;
  }
}

void HeldJoints::torques(const EquationsOfMotion& equations, double t, const double* q,
                         const double* qd, double* torque) {
  EffectsInForce& effects = *equations.effects;
  accelerations_in_force(equations, t, q, qd, held_qdd_.data());
  set_free(effects);
  accelerations_in_force(equations, t, q, qd, free_qdd_.data());
  for (int j = 0; j < n_; ++j) effects.hold(j, is_held(j));
  fill_mass_matrix(q);
  double sum = 0.0;
  double size = 0.0;
  for (int i = n_ - 1; i >= 0; --i) {
    const double* const row = mass_.data() + static_cast<std::ptrdiff_t>(i) * n_;
    for (int k = 0; k < n_; ++k) {
      sum += row[k] * (held_qdd_[k] - free_qdd_[k]);
      size += std::abs(row[k]) * (std::abs(held_qdd_[k]) + std::abs(free_qdd_[k]));
    }
    torque[i] = sum;
    size_[i] = size;
  }
}

Impact HeldJoints::strike(const EquationsOfMotion& equations, double t, const double* q, double* qd,
                          bool is_plastic) {
  rows_.clear();
  for (int j = 0; j < n_; ++j) {
    if (supports_[j].is_locked || contact(j, q) != Side::none) rows_.push_back(j);
  }
  problem_.resize(static_cast<int>(rows_.size()));
  fill_mass_matrix(q);
  fill_responses();
  std::vector<double> before(rows_.size());
  std::vector<char> stays(rows_.size());
  std::ranges::fill(bounced_, 0);
  for (int r = 0; r < problem_.size; ++r) {
    const int j = rows_[r];
    const JointSupport& support = supports_[j];
    const bool is_lower = contact(j, q) == Side::lower;
    before[r] = direction_ * speed(qd, j);
    problem_.a[r] = before[r];
    const bool must_stay = support.is_locked || is_captured(j);
    problem_.lower[r] = must_stay || !is_lower ? -never : 0.0;
    problem_.upper[r] = must_stay || is_lower ? never : 0.0;
    const bool bounces = !must_stay && !is_plastic && strikes(j, q, qd) &&
                         std::abs(before[r]) >= capture_speed(j, q);
    const double e = is_lower ? support.restitution_lower : support.restitution_upper;
    stays[r] = bounces && e > 0.0 ? 0 : 1;
    if (bounces) problem_.a[r] += e * before[r];
    bounced_[j] = stays[r] == 0 ? 1 : 0;
  }
  solve();

  std::vector<double> change(n_, 0.0);
  for (int r = 0; r < problem_.size; ++r) {
    const double* const x = response_.data() + static_cast<std::ptrdiff_t>(r) * n_;
    for (int i = 0; i < n_; ++i) change[i] += problem_.lambda[r] * x[i];
  }
  solve_upper(n_, factor_.data(), change.data());
  for (int i = 0; i < n_; ++i) qd[i] += direction_ * change[i];
  Impact impact;
  for (int r = 0; r < problem_.size; ++r) {
    const int j = rows_[r];
    if (stays[r] != 0 && problem_.at[r] == Bound::between) qd[j] = j > 0 ? qd[j - 1] : 0.0;
    impact.loss -= 0.5 * problem_.lambda[r] * (before[r] + direction_ * speed(qd, j));
  }
  EffectsInForce& effects = *equations.effects;
  if (!effects.pivots.empty()) {
    double x, y;
    effects.compute_waves(t, 0);
    effects.pivot_velocity(t, x, y);
    for (int i = 0; i < n_; ++i) {
      const double moment = direction_ * inertia_.first_moment[i] * change[i];
      impact.work_of_drive += moment * (y * cosine_[i] - x * sine_[i]);
    }
  }
  return impact;
}

bool HeldJoints::settle(double* q, double* qd) const {
  bool changed = false;
  for (int j = 0; j < n_; ++j) {
    const double rate_before = j > 0 ? qd[j - 1] : 0.0;
    // What does not turn at all is where it was.
    if (!is_held(j) || (rate_before == 0.0 && qd[j] == 0.0)) continue;
    q[j] = j > 0 ? q[j - 1] + holds_[j].angle : holds_[j].angle;
    qd[j] = rate_before;
    changed = true;
  }
  return changed;
}

std::vector<double> HeldJoints::memory() const {
  std::vector<double> memory;
  for (const Hold& hold : holds_) {
    memory.insert(memory.end(), {hold.is_held, hold.angle, hold.least, hold.most});
  }
  return memory;
}

std::size_t HeldJoints::restore(EffectsInForce& effects, const std::vector<double>& memory,
                                std::size_t from) {
  const std::size_t end = from + 4 * holds_.size();
  if (memory.size() < end) {
    throw std::invalid_argument("the modes of this solution are not those of its scene");
  }
  for (int j = 0; j < n_; ++j) {
    const double* const at = memory.data() + from + static_cast<std::size_t>(4 * j);
    holds_[j] = {.is_held = at[0], .angle = at[1], .least = at[2], .most = at[3]};
    effects.hold(j, is_held(j));
  }
  return end;
}

}  // namespace pendcore
