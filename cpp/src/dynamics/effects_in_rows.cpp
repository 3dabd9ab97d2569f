#include "dynamics/effects_in_rows.hpp"

#include <algorithm>

#include "dynamics/inertia.hpp"
#include "dynamics/row.hpp"
#include "pendcore/effects/lock.hpp"

namespace pendcore {

namespace {

template <class Row>
struct ForceProbe {
  bool is_called = false;
  void couple(const Row& /*tau*/) {}
  void generalised(const Row& /*Q*/) {}
  void force(const Row& /*moment*/, const Row& /*fx*/, const Row& /*fy*/) { is_called = true; }
};

template <class Row, class Law>
bool calls_force(const Law& law) {
  constexpr int room = 8;
  const double zeros[3 * room]{};
  const double* const z = zeros + room;
  const RowInArrays<Row> at({z, z, z, z, z, z, z}, 0.0, 0);
  ForceProbe<Row> probe;
  law.add(at, probe);
  return probe.is_called;
}

bool is_couple(const Effect& effect) { return effect->couple(0).has_value(); }

}  // namespace

EffectsOfRun::EffectsOfRun(const Scene& scene)
    : effects(scene.effects),
      modes(scene.effects.size(), 0),
      number_of_wave(scene.effects.size(), -1),
      number_of_law_(scene.effects.size(), 0) {
  held.assign(scene.links.size(), 0);
  for (const Lock& lock : effects_of<Lock>(scene)) hold(lock.joint - 1, true);
  std::vector<Sinusoid> all;
  const auto add_waves = [&](std::size_t i) {
    const std::vector<Sinusoid> of_effect = effects[i]->waves();
    if (!of_effect.empty()) number_of_wave[i] = static_cast<int>(all.size());
    all.insert(all.end(), of_effect.begin(), of_effect.end());
  };
  for (std::size_t i = 0; i < effects.size(); ++i) {  // the first waves are those of the pivots
    const auto law = effects[i]->pivot_law(0);
    if (!law) continue;
    add_waves(i);
    number_of_law_[i] = pivots.size();
    pivots.emplace_back();
    put_pivot(i, *law);
  }
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (number_of_wave[i] < 0) add_waves(i);
  }
  make_room_for_waves(static_cast<int>(all.size()));
  for (int k = 0; k < waves; ++k) {
    angular_frequency.set(k, all[k].angular_frequency);
    phase.set(k, all[k].phase);
  }
}

/// Puts the law of a pivot in force, with the numbers that its waves have among all.
void EffectsOfRun::put_pivot(std::size_t i, const PivotLaw& law) {
  PivotLaw& pivot = pivots[number_of_law_[i]];
  pivot = law;
  for (PivotLaw::Axis* axis : {&pivot.x, &pivot.y}) axis->wave += std::max(number_of_wave[i], 0);
}

void EffectsOfRun::hold(int joint, bool is_held) {
  held[joint] = is_held ? 1 : 0;
  any_held = std::ranges::find(held, 1) != held.end();
}

void EffectsOfRun::call(const UserLaw& user, double t, const Dual<double>* q,
                        const Dual<double>* qd, Dual<double>* Q) const {
  const std::size_t n = held.size();
  user_room_.resize(3 * n);
  double* const angles = user_room_.data();
  double* const rates = angles + n;
  double* const forces = rates + n;
  double size = 1.0;  // the largest of the values that change
  for (std::size_t i = 0; i < n; ++i) {
    if (q[i].slope != 0.0) size = std::max(size, std::abs(q[i].value));
    if (qd[i].slope != 0.0) size = std::max(size, std::abs(qd[i].value));
  }
  const double step = 0x1p-17 * size;  // the cube root of the rounding unit balances both errors
  auto forces_at = [&](double along) {
    for (std::size_t i = 0; i < n; ++i) {
      angles[i] = q[i].value + along * q[i].slope;
      rates[i] = qd[i].value + along * qd[i].slope;
      forces[i] = 0.0;
    }
    call(user, t, angles, rates, forces);
  };
  forces_at(0.0);
  for (std::size_t i = 0; i < n; ++i) Q[i].value = forces[i];
  forces_at(step);
  for (std::size_t i = 0; i < n; ++i) Q[i].slope = forces[i];
  forces_at(-step);
  for (std::size_t i = 0; i < n; ++i) {
    const double ahead = Q[i].slope;
    Q[i].slope = (ahead - forces[i]) / (2.0 * step);
    if (std::isfinite(Q[i].slope)) continue;  // otherwise a one-sided difference is taken
    Q[i].slope = (std::isfinite(ahead) ? ahead - Q[i].value : Q[i].value - forces[i]) / step;
  }
}

template <class Row>
EffectsInRows<Row>::EffectsInRows(const Scene& scene) : EffectsOfRun(scene) {
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const EffectBehaviour& effect = *effects[i];
    const int place = std::max(effect.joint(), effect.link()) - 1;
    place_of_.push_back(place);
    const Link& link = scene.links[std::max(place, 0)];
    link_there_.push_back({link.mass, link.length, link.center, scene.gravity});
    if (auto law = effect.user_law(0)) {
      number_of_law_[i] = users.size();
      users.push_back(*law);
    }
    if (is_couple(effects[i])) {
      const int row = place / width;
      const bool is_new = std::ranges::find(couples, row, &Couples<Row>::row) == couples.end();
      if (is_new) couples.push_back({.row = row});
    } else {
      add_law(i);
    }
  }
  are_couples_alone = waves == 0 && pivots.empty() && users.empty() && entries.empty();
  if constexpr (width == 2) find_two_waves(scene);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    has_modes |= effects[i]->has_modes();
    put_mode(i, effects[i]->mode_at(0.0, 0.0, 0.0, true));
  }
}

/// Puts effect number i into a free lane of a law that it can share, or else into a new law.
template <class Row>
void EffectsInRows<Row>::add_law(std::size_t i) {
  const auto any = effects[i]->law(0, link_there_[i]);
  if (!any) return;
  const int row = place_of_[i] / width;
  const unsigned wanted = 1U << (place_of_[i] % width);
  const Account account = effects[i].info().account;
  std::visit(
      [&]<template <class> class Law>(const Law<double>& one) {
        auto& laws = laws_like(one);
        auto found = std::ranges::find_if(laws, [&](const SharedLaw<Law, Row>& other) {
          return other.row == row && other.account == account && (other.taken & wanted) == 0 &&
                 Law<Row>::shared(other.law) == Law<double>::shared(one);
        });
        if (found == laws.end()) {
          laws.reserve(effects.size());  // entries point to them
          found = laws.insert(laws.end(), {.law = {}, .row = row, .account = account});
          Law<Row>::shared(found->law) = Law<double>::shared(one);
          entries.push_back({.law = &*found, .row = row, .account = account});
        }
        found->taken |= wanted;
        number_of_law_[i] = static_cast<std::size_t>(found - laws.begin());
        has_forces |= calls_force<Row>(found->law);
      },
      *any);
}

template <class Row>
void EffectsInRows<Row>::put_mode(std::size_t i, int mode) {
  modes[i] = mode;
  if (const auto law = effects[i]->pivot_law(mode)) {
    put_pivot(i, *law);
  } else if (const auto user = effects[i]->user_law(mode)) {
    users[number_of_law_[i]] = *user;
  } else if (is_couple(effects[i])) {
    sum_couples(place_of_[i]);
  } else if (const auto any = effects[i]->law(mode, link_there_[i])) {
    const int lane = place_of_[i] % width;
    const auto put = [lane](Row& all, double of_one) { set_lane(all, lane, of_one); };
    std::visit(
        [&](const auto& one) { each_field(laws_like(one)[number_of_law_[i]].law, one, put); },
        *any);
  }
}

/// Adds up the couples of all effects on one joint, in its lane.
template <class Row>
void EffectsInRows<Row>::sum_couples(int joint) {
  Couple sum;
  bool has_start = false;
  std::erase_if(joint_waves, [&](const JointWave& wave) { return wave.joint == joint; });
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (place_of_[i] != joint) continue;
    const std::optional<Couple> one = effects[i]->couple(modes[i]);
    if (!one) continue;
    add_couple(sum, *one, has_start);
    if (one->gain != 0.0) joint_waves.push_back({joint, number_of_wave[i], one->gain});
  }
  if constexpr (width == 2) {
    two_waves.torque[0] = two_waves.torque[1] = Pair{};
    for (const JointWave& one : joint_waves) {
      if (one.wave >= 2) continue;
      Pair& torque = two_waves.torque[one.wave];
      torque[one.joint] += one.gain;
      if (one.joint > 0) torque[one.joint - 1] -= one.gain;
    }
  }
  Couples<Row>& row = *std::ranges::find(couples, joint / width, &Couples<Row>::row);
  const int lane = joint % width;
  each_field(row, sum, [lane](Row& all, double one) { set_lane(all, lane, one); });
  row.has_powers = sum_of_lanes(Row(absolute(row.on_phid2) + absolute(row.on_phid3))) != 0.0;
}

template <class Row>
std::vector<int> EffectsInRows<Row>::kinds() const {
  std::vector<int> kinds{waves, static_cast<int>(users.size()), static_cast<int>(pivots.size())};
  for (const PivotLaw& law : pivots) kinds.insert(kinds.end(), {law.x.wave, law.y.wave});
  kinds.push_back(static_cast<int>(joint_waves.size()));
  for (const JointWave& one : joint_waves) kinds.insert(kinds.end(), {one.joint, one.wave});
  kinds.push_back(static_cast<int>(couples.size()));
  for (const auto& one : couples) kinds.insert(kinds.end(), {one.row, int{one.has_powers}});
  for (const Entry& entry : entries) {
    kinds.insert(kinds.end(), {static_cast<int>(entry.law.index()), entry.row});
  }
  return kinds;
}

/// Finds what the first two waves do to the pivot; sum_couples() does this for motors.
template <class Row>
void EffectsInRows<Row>::find_two_waves(const Scene& scene) {
  const Inertia inertia(scene);
  for (int i = 0; i < 2; ++i) {
    const double a = inertia.links[i].first_moment;
    for (const auto& [x, y, start] : pivots) {
      if (x.wave < 2) two_waves.on_sine[x.wave][i] += a * x.gain;
      if (y.wave < 2) two_waves.on_cosine[y.wave][i] -= a * y.gain;
    }
  }
}

template class EffectsInRows<double>;
template class EffectsInRows<Pair>;
template class EffectsInRows<Pack<4>>;

template <class Row>
Row of_users(const EffectsOfRun& effects, double t, const Row& q, const Row& qd) {
  using Number = typename Lanes<Row>::Number;
  constexpr int n = Lanes<Row>::width;
  Number angles[n];
  Number rates[n];
  store(angles, q);
  store(rates, qd);
  Row sum{};
  for (const UserLaw& user : effects.users) {
    Number forces[n] = {};
    effects.call(user, t, angles, rates, forces);
    sum += load<Row>(forces);
  }
  return sum;
}

template double of_users(const EffectsOfRun&, double, const double&, const double&);
template Pair of_users(const EffectsOfRun&, double, const Pair&, const Pair&);
template Dual<double> of_users(const EffectsOfRun&, double, const Dual<double>&,
                               const Dual<double>&);
template Dual<Pair> of_users(const EffectsOfRun&, double, const Dual<Pair>&, const Dual<Pair>&);

}  // namespace pendcore
