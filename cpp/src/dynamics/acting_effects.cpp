#include "pendcore/dynamics/acting_effects.hpp"

#include <algorithm>

#include "pendcore/dynamics/inertia.hpp"
#include "pendcore/dynamics/row.hpp"

namespace pendcore {

EffectsInForce::EffectsInForce(const Scene& scene)
    : effects(compiled(scene).effects),
      modes(scene.effects.size(), 0),
      number_of_wave(scene.effects.size(), -1) {
  held.assign(scene.links.size(), 0);
  for (const Lock& lock : effects_of<Lock>(scene)) hold(lock.joint - 1, true);
  for (const Effect& effect : effects) {
    if (const auto* user = std::get_if<CompiledUser>(&effect)) users.push_back(*user);
    const auto* pivot = std::get_if<DrivenPivot>(&effect);
    if (pivot == nullptr) continue;
    auto law = std::make_shared<DrivenPivot::Law>();
    auto swing = [this](const std::optional<Sinusoid>& wave, DrivenPivot::Law::Axis& axis) {
      if (!wave) return;
      const double w = wave->angular_frequency;
      axis.gain = -wave->amplitude * w * w;
      axis.swing = wave->amplitude * w;
      axis.wave = add_wave(*wave);
    };
    swing(pivot->x, law->x);
    swing(pivot->y, law->y);
    pivots.push_back(law);
  }
}

void EffectsInForce::hold(int joint, bool is_held) {
  held[joint] = is_held ? 1 : 0;
  any_held = std::ranges::find(held, 1) != held.end();
}

void EffectsInForce::call(const CompiledUser& user, double t, const Dual<double>* q,
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

int EffectsInForce::add_wave(const Sinusoid& wave) {
  angular_frequency.push_back(wave.angular_frequency);
  phase.push_back(wave.phase);
  return waves++;
}

void EffectsInForce::finish_waves() {
  for (int k = 0; k < std::min(waves, 2); ++k) {
    two_waves.angular_frequency[k] = angular_frequency[k];
    two_waves.phase[k] = phase[k];
  }
  const std::size_t room = waves + 8;
  angular_frequency.resize(room);
  phase.resize(room);
  wave_sine.assign(room, 0.0);
  wave_cosine.assign(room, 0.0);
}

namespace {

/// The joint or link that an effect acts on, counted from 0.
template <class Kind>
int place_of(const Kind& effect) {
  if constexpr (OnJoint<Kind>) {
    return effect.joint - 1;
  } else {
    return effect.link - 1;
  }
}

template <class Kind>
double group_of(const Kind& effect) {
  if constexpr (HasGroup<Kind>) {
    return effect.group();
  } else {
    return 0.0;
  }
}

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

template <class Kind>
bool is_couple(const Kind& effect) {
  if constexpr (HasCouple<Kind>) {
    return effect.couple(0).has_value();
  } else {
    return false;
  }
}

}  // namespace

template <class Row>
ActingEffects<Row>::ActingEffects(const Scene& scene)
    : EffectsInForce(scene), places_(effects.size()) {
  std::size_t pivots_so_far = 0;
  std::size_t users_so_far = 0;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& effect) {
          if constexpr (HasWave<Kind>) {
            if (const auto wave = effect.wave()) number_of_wave[i] = add_wave(*wave);
          }
          if constexpr (std::is_same_v<Kind, DrivenPivot>) places_[i].number = pivots_so_far++;
          if constexpr (std::is_same_v<Kind, CompiledUser>) places_[i].number = users_so_far++;
          if constexpr (HasCouple<Kind>) {
            if (is_couple(effect)) {
              const int row = place_of(effect) / width;
              const bool is_new =
                  std::ranges::find(couples, row, &Couples<Row>::row) == couples.end();
              if (is_new) couples.push_back({.row = row});
              return;
            }
          }
          if constexpr (HasLaw<Kind>) add_law(i, effect, scene);
        },
        effects[i]);
  }
  finish_waves();
  if constexpr (width == 2) find_two_waves(scene);
  for (std::size_t i = 0; i < effects.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& effect) {
          if constexpr (HasModes<Kind>) {
            has_modes |= effect.has_modes();
            put_mode(i, effect.mode_at(0.0, 0.0, 0.0, true));
          } else if (is_couple(effect)) {
            put_mode(i, 0);
          }
        },
        effects[i]);
  }
}

/// Puts effect number i into a free lane of a law that it can share, or else into a new law.
template <class Row>
template <class Kind>
void ActingEffects<Row>::add_law(std::size_t i, const Kind& effect, const Scene& scene) {
  const int place = place_of(effect);
  const int row = place / width;
  const int lane = place % width;
  const unsigned wanted = 1U << lane;
  const double group = group_of(effect);
  std::vector<SharedLaw<Kind, Row>>& laws = laws_of<Kind>();
  auto found = std::ranges::find_if(laws, [&](const SharedLaw<Kind, Row>& one) {
    return one.row == row && one.group == group && (one.taken & wanted) == 0;
  });
  if (found == laws.end()) {
    laws.reserve(effects.size());  // entries point to them
    found = laws.insert(laws.end(), {.law = {}, .row = row, .group = group});
    entries.push_back({.law = &*found, .row = row});
  }
  found->taken |= wanted;
  places_[i] = {static_cast<std::size_t>(found - laws.begin()), lane};
  const Link& link = scene.links[place];
  effect.put(found->law, lane, {link.mass, link.length, link.center, scene.gravity});
  has_forces |= calls_force<Row>(found->law);
}

template <class Row>
void ActingEffects<Row>::put_mode(std::size_t i, int mode) {
  modes[i] = mode;
  std::visit(
      [&]<class Kind>(const Kind& effect) {
        if constexpr (std::is_same_v<Kind, DrivenPivot>) {
          effect.put_mode(*pivots[places_[i].number], 0, mode);
        }
        if constexpr (std::is_same_v<Kind, CompiledUser>) users[places_[i].number].enter(mode);
        if constexpr (HasCouple<Kind>) {
          if (is_couple(effect)) {
            sum_couples(place_of(effect));
            return;
          }
        }
        if constexpr (HasLaw<Kind> && HasModes<Kind>) {
          const auto [number, lane] = places_[i];
          effect.put_mode(laws_of<Kind>()[number].law, lane, mode);
        }
      },
      effects[i]);
}

/// Adds up the couples of all effects on one joint, in its lane.
template <class Row>
void ActingEffects<Row>::sum_couples(int joint) {
  Couple sum;
  bool has_start = false;
  std::erase_if(joint_waves, [&](const JointWave& wave) { return wave.joint == joint; });
  for (std::size_t i = 0; i < effects.size(); ++i) {
    std::visit(
        [&]<class Kind>(const Kind& effect) {
          if constexpr (HasCouple<Kind>) {
            if (place_of(effect) != joint || !is_couple(effect)) return;
            const Couple one = *effect.couple(modes[i]);
            if (one.slope != 0.0 || one.start != 0.0) {
              // The common start is the latest, even if starts are negative: it keeps t - start
              // small.
              const double start = has_start ? std::max(sum.start, one.start) : one.start;
              sum.held +=
                  sum.slope * (start - sum.start) + one.held + one.slope * (start - one.start);
              sum.start = start;
              sum.slope += one.slope;
              has_start = true;
            } else {
              sum.held += one.held;
            }
            sum.on_phi += one.on_phi;
            sum.on_phid += one.on_phid;
            sum.on_phid2 += one.on_phid2;
            sum.on_phid3 += one.on_phid3;
            if (one.gain != 0.0) joint_waves.push_back({joint, number_of_wave[i], one.gain});
          }
        },
        effects[i]);
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
}

/// Finds what the first two waves do to the pivot; sum_couples() does this for motors.
template <class Row>
void ActingEffects<Row>::find_two_waves(const Scene& scene) {
  const Inertia inertia(scene);
  for (int i = 0; i < 2; ++i) {
    const double a = inertia.links[i].first_moment;
    for (const auto& law : pivots) {
      if (law->x.wave < 2) two_waves.on_sine[law->x.wave][i] += a * law->x.gain;
      if (law->y.wave < 2) two_waves.on_cosine[law->y.wave][i] -= a * law->y.gain;
    }
  }
}

template class ActingEffects<double>;
template class ActingEffects<Pair>;
template class ActingEffects<Pack<4>>;

template <class Row>
Row of_users(const EffectsInForce& effects, double t, const Row& q, const Row& qd) {
  using Number = typename Lanes<Row>::Number;
  constexpr int n = Lanes<Row>::width;
  Number angles[n];
  Number rates[n];
  store(angles, q);
  store(rates, qd);
  Row sum{};
  for (const CompiledUser& user : effects.users) {
    Number forces[n] = {};
    effects.call(user, t, angles, rates, forces);
    sum += load<Row>(forces);
  }
  return sum;
}

template double of_users(const EffectsInForce&, double, const double&, const double&);
template Pair of_users(const EffectsInForce&, double, const Pair&, const Pair&);
template Dual<double> of_users(const EffectsInForce&, double, const Dual<double>&,
                               const Dual<double>&);
template Dual<Pair> of_users(const EffectsInForce&, double, const Dual<Pair>&, const Dual<Pair>&);

std::shared_ptr<EffectsInForce> effects_in_force(const Scene& scene) {
  switch (scene.links.size()) {
    case 1: return std::make_shared<ActingEffects<double>>(scene);
    case 2: return std::make_shared<ActingEffects<Pair>>(scene);
    default: return std::make_shared<ActingEffects<Pack<4>>>(scene);
  }
}

}  // namespace pendcore
