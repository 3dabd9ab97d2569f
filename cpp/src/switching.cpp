#include "pendcore/switching.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pendcore/message.hpp"

namespace pendcore {
namespace {

const DryJointFriction* friction(const Effect& effect) {
  return std::get_if<DryJointFriction>(&effect);
}

}  // namespace

bool Switching::is_needed(const Scene& scene) {
  return std::ranges::any_of(scene.effects, [](const Effect& effect) {
    return std::visit(
        []<class Kind>(const Kind& one) {
          if constexpr (std::is_same_v<Kind, Lock>) return true;
          if constexpr (requires { one.has_modes(); }) return one.has_modes();
          return false;
        },
        effect);
  });
}

Switching::Switching(const Scene& scene, const EquationsOfMotion& equations)
    : scene_(scene),
      equations_(equations),
      n_(static_cast<int>(scene.links.size())),
      modes_(scene.effects.size(), 0),
      lock_angle_(scene.links.size(), std::numeric_limits<double>::quiet_NaN()) {
  scene_.effects = equations.effects->effects;  // compiled
  for (const Effect& effect : scene_.effects) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.break_times(times_); }) one.break_times(times_);
        },
        effect);
  }
  std::ranges::sort(times_);
}

void Switching::put_mode(std::size_t i, int mode) {
  modes_[i] = mode;
  equations_.effects->put_mode(i, mode);
}

void Switching::restore(const std::vector<int>& modes, const double* start, bool forward) {
  forward_ = forward;
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    if (i < modes.size()) put_mode(i, modes[i]);
  }
  set_locks(start);
  collect_guards();
}

void Switching::set_locks(const double* start) {
  for (const Lock& lock : effects_of<Lock>(scene_)) {
    has_locks_ = true;
    lock_angle_[lock.joint - 1] = lock.angle.value_or(of_joint(start, lock.joint - 1));
  }
}

void Switching::collect_guards() {
  guards_.clear();
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& one) {
          if constexpr (requires { one.has_modes(); }) {
            if (!one.has_modes()) return;
            int joint = 0;
            if constexpr (requires { one.joint; }) joint = one.joint - 1;
            const std::vector<Guard> guards = one.guards(modes_[i]);
            for (std::size_t k = 0; k < guards.size(); ++k) {
              guards_.push_back({.effect = i, .number = k, .joint = joint, .guard = guards[k]});
            }
          }
        },
        scene_.effects[i]);
  }
}

Status Switching::begin(double t, double* y, bool forward) {
  forward_ = forward;
  const double* const q = y;
  const double* const qd = y + n_;
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& one) {
          if constexpr (requires { one.has_modes(); }) {
            if (!one.has_modes()) return;
            double phi = 0.0;
            double phid = 0.0;
            if constexpr (requires { one.joint; }) {
              phi = of_joint(q, one.joint - 1);
              phid = of_joint(qd, one.joint - 1);
            }
            put_mode(i, one.mode_at(t, phi, phid, forward));
          }
        },
        scene_.effects[i]);
  }
  set_locks(y);
  settle(-1, t, y);
  bool any_friction = false;
  for (const Effect& effect : scene_.effects) any_friction |= friction(effect) != nullptr;
  if (any_friction && rests(t, q, qd)) {
    remark_ = "dry friction holds every joint";
    return Status::at_rest;
  }
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    const DryJointFriction* one = friction(scene_.effects[i]);
    if (one == nullptr || of_joint(qd, one->joint - 1) != 0.0) continue;
    const int mode = sliding_mode(i, t, q, qd);
    if (mode == 0) {
      collect_guards();
      return Status::at_rest;
    }
    put_mode(i, mode);
  }
  collect_guards();
  return Status::finished;
}

double Switching::next_time(double t) const {
  if (forward_) {
    const auto next = std::ranges::upper_bound(times_, t);
    return next == times_.end() ? never : *next;
  }
  const auto next = std::ranges::lower_bound(times_, t);
  return next == times_.begin() ? -never : *(next - 1);
}

double Switching::guard(int k, double t, const double* y) const {
  const Watch& watch = guards_[k];
  const Guard& g = watch.guard;
  double value =
      g.offset + g.on_phi * of_joint(y, watch.joint) + g.on_phid * of_joint(y + n_, watch.joint);
  if (g.on_wave != 0.0) {
    const EffectsInForce& effects = *equations_.effects;
    double sine, cosine;
    sine_cosine(effects.wave_angles<double>(t, effects.number_of_wave[watch.effect]), sine, cosine);
    value += g.on_wave * sine;
  }
  return value;
}

bool Switching::polynomial(int k, const double* rows, int degree, int dimension,
                           double* coefficients) const {
  const Guard& g = guards_[k].guard;
  if (g.on_wave != 0.0) return false;
  const int joint = guards_[k].joint;
  for (int p = 0; p <= degree; ++p) {
    const double* const row = rows + static_cast<std::ptrdiff_t>(p) * dimension;
    coefficients[p] = g.on_phi * of_joint(row, joint) + g.on_phid * of_joint(row + n_, joint);
  }
  coefficients[0] += g.offset;
  return true;
}

bool Switching::settle(int k, double /*t*/, double* y) const {
  bool changed = false;
  double* const q = y;
  double* const qd = y + n_;
  if (k >= 0) {
    // A guard on a rate alone: the rate is zero there.
    const Watch& watch = guards_[k];
    if (watch.guard.on_phi == 0.0 && watch.guard.on_wave == 0.0 && watch.guard.offset == 0.0) {
      qd[watch.joint] = watch.joint > 0 ? qd[watch.joint - 1] : 0.0;
      changed = true;
    }
  }
  for (int j = 0; j < n_; ++j) {
    if (std::isnan(lock_angle_[j])) continue;
    q[j] = j > 0 ? q[j - 1] + lock_angle_[j] : lock_angle_[j];
    qd[j] = j > 0 ? qd[j - 1] : 0.0;
    changed = true;
  }
  return changed;
}

Status Switching::cross(int k, double t, const double* y) {
  const double* const q = y;
  const double* const qd = y + n_;
  if (k >= 0) {
    const Watch watch = guards_[k];
    const Effect& effect = scene_.effects[watch.effect];
    int mode = std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.has_modes(); }) {
            return one.next_mode(modes_[watch.effect], watch.number);
          } else {
            return 0;
          }
        },
        effect);
    if (friction(effect) != nullptr) {
      if (rests(t, q, qd)) {
        remark_ = "dry friction holds every joint";
        return Status::at_rest;
      }
      mode = sliding_mode(watch.effect, t, q, qd);
      if (mode == 0) return Status::at_rest;
    }
    put_mode(watch.effect, mode);
  } else {
    for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
      std::visit(
          [&](const auto& one) {
            if constexpr (requires {
                            one.break_times(times_);
                            one.mode_at(t, 0.0, 0.0, true);
                          }) {
              if (one.last_time() < never) put_mode(i, one.mode_at(t, 0.0, 0.0, forward_));
            }
          },
          scene_.effects[i]);
    }
  }
  collect_guards();
  return Status::finished;
}

int Switching::sliding_mode(std::size_t i, double t, const double* q, const double* qd) {
  const int before = modes_[i];
  const int joint = friction(scene_.effects[i])->joint - 1;
  std::vector<double> qdd(n_);
  for (const int mode : {-before, before}) {
    put_mode(i, mode);
    accelerations_in_force(equations_, t, q, qd, qdd.data());
    // Backward in time the rate that a step arrives at has the other sign; refused by check_run.
    if (mode * of_joint(qdd.data(), joint) > 0.0) return mode;
  }
  put_mode(i, before);
  remark_ = "joint " + std::to_string(joint + 1) +
            " comes to rest under dry friction while other links may still move: sticking is not "
            "simulated";
  return 0;
}

/// Nothing moves, and every joint can carry the torque that holds what is beyond it.
bool Switching::rests(double t, const double* q, const double* qd) {
  for (int i = 0; i < n_; ++i) {
    if (qd[i] != 0.0) return false;
  }
  std::vector<double> holds(n_, 0.0);
  std::vector<int> before = modes_;
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    const Effect& effect = scene_.effects[i];
    if (const auto* lock = std::get_if<Lock>(&effect)) holds[lock->joint - 1] = never;
    if (const DryJointFriction* one = friction(effect)) {
      holds[one->joint - 1] += one->static_.value_or(one->coulomb);
      put_mode(i, 0);
    }
  }
  std::vector<double> qdd(n_);
  accelerations_in_force(equations_, t, q, qd, qdd.data());
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (friction(scene_.effects[i]) != nullptr) put_mode(i, before[i]);
  }
  std::vector<double> matrix(static_cast<std::size_t>(n_) * n_);
  mass_matrix(Inertia(scene_), {q, static_cast<std::size_t>(n_)}, matrix);
  double torque = 0.0;
  for (int i = n_ - 1; i >= 0; --i) {
    for (int j = 0; j < n_; ++j) torque += matrix[static_cast<std::size_t>(i) * n_ + j] * qdd[j];
    if (!(std::abs(torque) <= holds[i])) return false;
  }
  return true;
}

}  // namespace pendcore
