#include "dynamics/energetics/ledger.hpp"

#include <algorithm>

#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/payload.hpp"

namespace pendcore {
namespace {

/// Calls visit(entry, at, loads) for each law of the effects.
template <class Visit>
void for_each_law(const EffectsOfRun& effects, double t, const LinkMemory& links,
                  const Visit& visit) {
  with_row_for(effects.held.size(), [&]<class Row>() {
    for (const auto& entry : dynamic_cast<const EffectsInRows<Row>&>(effects).entries) {
      const RowInArrays<Row> at(links.arrays(), t, entry.row);
      RowLoads<Row> loads;
      EffectsInRows<Row>::add(entry, at, loads);
      visit(entry, at, loads);
    }
  });
}

template <class Powers>
void book(Powers& power, Account account, double value) {
  power[static_cast<std::size_t>(account)] += is_loss(account) ? -value : value;
}

}  // namespace

std::vector<Account> accounts_of(const Scene& scene) {
  std::vector<Account> found;
  for (const Effect& effect : scene.effects) {
    const Account account = effect.info().account;
    if (account != Account::none) found.push_back(account);
    if (effect->has_wind()) found.push_back(Account::wind);
  }
  std::ranges::sort(found);
  found.erase(std::ranges::unique(found).begin(), found.end());
  return found;
}

LinkMemory::LinkMemory(const Scene& scene) : n_(static_cast<int>(scene.links.size())) {
  for (std::vector<double>* row : {&q, &qd, &s, &c, &length, &vx, &vy}) row->assign(n_ + 8, 0.0);
  for (int i = 0; i < n_; ++i) length[i + 1] = scene.links[i].length;
}

void LinkMemory::fill(const EffectsOfRun& effects, double t, const double* angles,
                      const double* rates) {
  effects.compute_waves(t, 0);
  double x, y;
  effects.pivot_velocity(t, x, y);
  std::copy_n(angles, n_, &q[1]);
  std::copy_n(rates, n_, &qd[1]);
  sine_cosine(&q[1], n_, &s[1], &c[1]);
  for (int i = 1; i <= n_; ++i) {
    vx[i] = x;
    vy[i] = y;
    x -= length[i] * qd[i] * s[i];
    y += length[i] * qd[i] * c[i];
  }
}

Ledger::Ledger(const Scene& scene, std::shared_ptr<EffectsOfRun> effects)
    : scene_(scene),
      effects_(std::move(effects)),
      accounts_(accounts_of(scene)),
      links_(scene),
      user_forces_(scene.links.size()) {}

void Ledger::powers(double t, const double* q, const double* qd, const double* qdd,
                    double* result) {
  Powers power{};
  links_.fill(*effects_, t, q, qd);
  add_laws(t, power);
  add_couples(t, power);
  if (!effects_->users.empty()) add_users(t, q, qd, power);
  if (!effects_->pivots.empty()) add_drive(t, qdd, power);
  for (std::size_t i = 0; i < accounts_.size(); ++i) {
    result[i] = power[static_cast<std::size_t>(accounts_[i])];
  }
}

/// Adds the powers of the laws: M . qd + F . v, and tau phid.
void Ledger::add_laws(double t, Powers& power) {
  force_x_ = force_y_ = 0.0;
  for_each_law(*effects_, t, links_, [&](const auto& entry, const auto& at, const auto& loads) {
    using Row = typename std::remove_cvref_t<decltype(at)>::Value;
    const Row all =
        loads.couples * at.phid() + loads.moments * at.qd + loads.fx * at.vx() + loads.fy * at.vy();
    force_x_ += sum_of_lanes(loads.fx);
    force_y_ += sum_of_lanes(loads.fy);
    double value = sum_of_lanes(all);
    EffectsInRows<Row>::visit(entry, [&]<class Law>(const Law& law) {
      if constexpr (requires { law.dissipation(at); }) {
        const double lost = sum_of_lanes(law.dissipation(at));
        book(power, Account::wind, value + lost);
        value = -lost;
      }
    });
    book(power, entry.account, value);
  });
}

void Ledger::add_couples(double t, Powers& power) const {
  for (std::size_t i = 0; i < effects_->effects.size(); ++i) {
    const Effect& effect = effects_->effects[i];
    const auto couple = effect->couple(effects_->modes[i]);
    if (!couple) continue;
    const double phi = relative(&links_.q[1], effect->joint());
    const double phid = relative(&links_.qd[1], effect->joint());
    const int wave = effects_->number_of_wave[i];
    const double sine = wave < 0 ? 0.0 : effects_->wave_sine[wave];
    book(power, effect.info().account, couple->torque(t, phi, phid, sine) * phid);
  }
}

void Ledger::add_users(double t, const double* q, const double* qd, Powers& power) {
  for (const UserLaw& user : effects_->users) {
    std::ranges::fill(user_forces_, 0.0);
    user(t, static_cast<int>(user_forces_.size()), q, qd, user_forces_.data());
    for (std::size_t i = 0; i < user_forces_.size(); ++i) {
      book(power, Account::user, user_forces_[i] * qd[i]);
    }
  }
}

/// Adds F_01 . v_0, where F_01 is the force that accelerates the mass centres (equations.hpp) less
/// the forces of the laws.
void Ledger::add_drive(double t, const double* qdd, Powers& power) const {
  double ax, ay;
  effects_->pivot_acceleration(t, ax, ay);
  double x = -force_x_;
  double y = -force_y_;
  for (std::size_t i = 1; i <= scene_.links.size(); ++i) {
    const Link& link = scene_.links[i - 1];
    const double square = links_.qd[i] * links_.qd[i];
    const double along_x = -qdd[i - 1] * links_.s[i] - square * links_.c[i];  // qdd n - qd^2 u
    const double along_y = qdd[i - 1] * links_.c[i] - square * links_.s[i];
    x += link.mass * (ax + link.center * along_x);
    y += link.mass * (ay + link.center * along_y - scene_.gravity);
    ax += link.length * along_x;
    ay += link.length * along_y;
  }
  for (const Payload& payload : effects_of<Payload>(scene_)) {
    x += payload.mass * ax;
    y += payload.mass * (ay - scene_.gravity);
  }
  book(power, Account::drive, x * links_.vx[1] + y * links_.vy[1]);
}

}  // namespace pendcore
