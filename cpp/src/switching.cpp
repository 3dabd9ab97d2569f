#include "pendcore/switching.hpp"

#include <algorithm>
#include <stdexcept>

#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/message.hpp"

namespace pendcore {
namespace {

/// Whether what is given of an effect by points in time does not go on from time t.
template <class Kind>
bool has_ended(const Kind& effect, double t, bool forward) {
  if constexpr (requires { effect.last_time(); }) {
    return forward ? t >= effect.last_time() : t <= effect.first_time();
  } else {
    return false;
  }
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
    : scene_(compiled(scene)),
      equations_(equations),
      n_(static_cast<int>(scene.links.size())),
      lock_angle_(scene.links.size(), std::numeric_limits<double>::quiet_NaN()) {}

std::vector<double> Switching::memory() const {
  const std::vector<int>& modes = equations_.effects->modes;
  std::vector<double> memory(modes.begin(), modes.end());
  memory.insert(memory.end(), lock_angle_.begin(), lock_angle_.end());
  return memory;
}

void Switching::restore(const std::vector<double>& memory, bool forward) {
  forward_ = forward;
  const std::size_t effects = scene_.effects.size();
  if (memory.size() != effects + n_) {
    throw std::invalid_argument("the modes of this solution are not those of its scene");
  }
  for (std::size_t i = 0; i < effects; ++i) put_mode(i, static_cast<int>(memory[i]));
  std::copy(memory.begin() + static_cast<std::ptrdiff_t>(effects), memory.end(),
            lock_angle_.begin());
  has_locks_ = std::ranges::any_of(lock_angle_, [](double angle) { return !std::isnan(angle); });
  collect_guards();
}

void Switching::set_locks(const double* start) {
  for (const Lock& lock : effects_of<Lock>(scene_)) {
    has_locks_ = true;
    lock_angle_[lock.joint - 1] = lock.angle.value_or(relative(start, lock.joint));
  }
}

int Switching::joint_of(std::size_t effect) const {
  return std::visit(
      [](const auto& one) {
        if constexpr (requires { one.joint; }) return one.joint;
        return 1;
      },
      scene_.effects[effect]);
}

void Switching::collect_guards() {
  guards_.clear();
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    if (is_locked(joint_of(i))) continue;
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.has_modes(); }) {
            if (!one.has_modes()) return;
            const std::vector<Guard> guards = one.guards(equations_.effects->modes[i]);
            for (std::size_t k = 0; k < guards.size(); ++k) {
              guards_.push_back(
                  {.effect = i, .number = k, .joint = joint_of(i), .guard = guards[k]});
            }
          }
        },
        scene_.effects[i]);
  }
}

void Switching::choose_modes_from(double t, const double* q, const double* qd) {
  choose_modes(*equations_.effects, t, q, qd, forward_);
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    const bool ended =
        std::visit([&](const auto& one) { return has_ended(one, t, forward_); }, scene_.effects[i]);
    if (ended) put_mode(i, -1);
  }
}

Status Switching::begin(double t, double* y, bool forward) {
  forward_ = forward;
  const double* const q = y;
  const double* const qd = y + n_;
  choose_modes_from(t, q, qd);
  set_locks(y);
  settle(-1, y);
  if (rests(t, q, qd)) return hold_every_joint();
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    if (!holding_torque(scene_.effects[i]) || is_locked(joint_of(i))) continue;
    if (relative(qd, joint_of(i)) != 0.0) continue;
    const int mode = sliding_mode(i, t, q, qd);
    if (mode == 0) return Status::stuck;
    put_mode(i, mode);
  }
  collect_guards();
  return Status::finished;
}

double Switching::next_time(double t) const {
  const bool is_known = forward_ ? asked_ <= t && t < next_time_ : next_time_ < t && t <= asked_;
  if (is_known) return next_time_;
  asked_ = t;
  next_time_ = forward_ ? never : -never;
  for (const Effect& effect : scene_.effects) {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.next_time(t, true); }) {
            const double next = one.next_time(t, forward_);
            next_time_ = forward_ ? std::min(next_time_, next) : std::max(next_time_, next);
          }
        },
        effect);
  }
  return next_time_;
}

double Switching::guard(int k, const double* y) const {
  const auto& [effect, number, joint, g] = guards_[k];
  return g.offset + g.on_phi * relative(y, joint) + g.on_phid * relative(y + n_, joint);
}

void Switching::polynomial(int k, const double* rows, int degree, int dimension,
                           double* coefficients) const {
  const auto& [effect, number, joint, g] = guards_[k];
  for (int p = 0; p <= degree; ++p) {
    const double* const row = rows + static_cast<std::ptrdiff_t>(p) * dimension;
    coefficients[p] = g.on_phi * relative(row, joint) + g.on_phid * relative(row + n_, joint);
  }
  coefficients[0] += g.offset;
}

bool Switching::settle(int k, double* y) const {
  bool changed = false;
  double* const q = y;
  double* const qd = y + n_;
  if (k >= 0) {
    const auto& [effect, number, joint, g] = guards_[k];
    if (g.on_phi == 0.0 && g.offset == 0.0) {  // on a rate alone: it is zero there
      qd[joint - 1] = joint > 1 ? qd[joint - 2] : 0.0;
      changed = true;
    }
  }
  for (int j = 0; j < n_; ++j) {
    if (!is_locked(j + 1)) continue;
    q[j] = j > 0 ? q[j - 1] + lock_angle_[j] : lock_angle_[j];
    qd[j] = j > 0 ? qd[j - 1] : 0.0;
    changed = true;
  }
  return changed;
}

Status Switching::cross(int k, double t, const double* y) {
  const double* const q = y;
  const double* const qd = y + n_;
  if (k < 0) {
    for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
      std::visit(
          [&](const auto& one) {
            if constexpr (requires { one.next_time(t, true); }) {
              if (!one.has_modes() || one.guards(equations_.effects->modes[i]).size() > 0) return;
              put_mode(i, has_ended(one, t, forward_) ? -1 : one.mode_at(t, 0.0, 0.0, forward_));
            }
          },
          scene_.effects[i]);
    }
    collect_guards();
    return Status::finished;
  }
  const Watch watch = guards_[k];
  const Effect& effect = scene_.effects[watch.effect];
  int mode = 0;
  if (holding_torque(effect)) {
    if (rests(t, q, qd)) return hold_every_joint();
    mode = sliding_mode(watch.effect, t, q, qd);
    if (mode == 0) return Status::stuck;
  } else {
    std::visit(
        [&](const auto& one) {
          if constexpr (requires { one.has_modes(); }) {
            mode = one.next_mode(equations_.effects->modes[watch.effect], watch.number);
          }
        },
        effect);
  }
  put_mode(watch.effect, mode);
  collect_guards();
  return Status::finished;
}

int Switching::sliding_mode(std::size_t i, double t, const double* q, const double* qd) {
  const int before = equations_.effects->modes[i];
  const int joint = joint_of(i);
  std::vector<double> qdd(n_);
  for (const int mode : {-before, before}) {
    put_mode(i, mode);
    accelerations_in_force(equations_, t, q, qd, qdd.data());
    if (mode * relative(qdd.data(), joint) > 0.0) return mode;
  }
  put_mode(i, before);
  remark_ = "joint " + std::to_string(joint);
  return 0;
}

/// Whether what holds now holds for ever.
bool Switching::is_for_good() const {
  return std::ranges::none_of(scene_.effects, [](const Effect& effect) {
    return std::visit(
        [](const auto& one) {
          if constexpr (requires { one.wave(); }) {
            if (one.wave()) return true;
          }
          if constexpr (requires { one.last_time(); }) {
            if (one.last_time() < never) return true;
          }
          return one.info.account == Account::drive || one.info.account == Account::user;
        },
        effect);
  });
}

Status Switching::hold_every_joint() {
  const bool for_good = is_for_good();
  remark_ = for_good ? "dry friction holds every joint"
                     : "dry friction holds every joint, until what depends on time moves one";
  return for_good ? Status::at_rest : Status::stuck;
}

/// Nothing moves, and every joint can carry the torque that holds what is beyond it.
bool Switching::rests(double t, const double* q, const double* qd) {
  for (int i = 0; i < n_; ++i) {
    if (qd[i] != 0.0) return false;
  }
  std::vector<double> holds(n_, 0.0);
  const std::vector<int> before = equations_.effects->modes;
  bool any_friction = false;
  for (std::size_t i = 0; i < scene_.effects.size(); ++i) {
    if (const auto torque = holding_torque(scene_.effects[i])) {
      any_friction = true;
      holds[joint_of(i) - 1] += *torque;
      put_mode(i, 0);
    }
  }
  for (int j = 0; j < n_; ++j) {
    if (is_locked(j + 1)) holds[j] = never;
  }
  std::vector<double> qdd(n_);
  if (any_friction) accelerations_in_force(equations_, t, q, qd, qdd.data());
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (holding_torque(scene_.effects[i])) put_mode(i, before[i]);
  }
  if (!any_friction) return false;
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
