/// \file
/// The effects that a Taylor series takes, with slopes along parameters of the scene: couples,
/// waves, motions of the pivot and joints that are held.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "dynamics/drives.hpp"
#include "dynamics/mechanism.hpp"

namespace pendcore {

/// The couple of an effect, if it has one: dry friction without a static peak has.
inline std::optional<CoupleOf<AlongNames>> couple_of(const Mechanism<AlongNames>::Acting& effect) {
  if (effect.couple || !effect.law) return effect.couple;
  const auto* const dry = std::get_if<StribeckLaw<AlongNames>>(&*effect.law);
  if (dry == nullptr || !is_zero(dry->peak)) return {};
  return CoupleOf<AlongNames>{.held = -dry->coulomb};
}
/// Whether a series takes all laws of a mechanism.
inline bool are_all_couples(const Mechanism<AlongNames>& mechanism) {
  return std::ranges::all_of(mechanism.effects,
                             [](const auto& one) { return !one.law || couple_of(one); });
}

/// For series that take EffectsInRows in the same way. A row is one number, or a pair.
template <class AnyRow>
struct EffectsWithSlopes : Drives<AlongNames> {
  using Number = AlongNames;
  using Row = AnyRow;

  std::vector<Couples<Row>> couples;
  std::vector<char> held;  ///< whether each joint is held
  bool any_held;

  EffectsWithSlopes(const Mechanism<AlongNames>& mechanism, const std::vector<char>& held_joints)
      : held(held_joints), any_held(std::ranges::find(held, 1) != held.end()) {
    int waves_before = 0;
    std::vector<Mechanism<AlongNames>::Wave> all;
    std::vector<CoupleOf<AlongNames>> sums(held.size());
    std::vector<int> starts(held.size());
    for (const auto& effect : mechanism.effects) {
      if (const std::optional<CoupleOf<AlongNames>> couple = couple_of(effect)) {
        bool has_start = starts[effect.place] != 0;
        add_couple(sums[effect.place], *couple, has_start);
        starts[effect.place] = has_start ? 1 : 0;
        if (!is_zero(couple->gain)) {
          joint_waves.push_back({effect.place, waves_before, couple->gain});
        }
      }
      if (effect.moves_pivot) {
        PivotLawOf<AlongNames>& pivot = pivots.emplace_back(effect.pivot);
        pivot.x.wave += waves_before;
        pivot.y.wave += waves_before;
      }
      all.insert(all.end(), effect.waves.begin(), effect.waves.end());
      waves_before = static_cast<int>(all.size());
    }
    make_room_for_waves(waves_before);
    for (int k = 0; k < waves; ++k) {
      angular_frequency.set(k, all[k].angular_frequency);
      phase.set(k, all[k].phase);
    }
    for (std::size_t j = 0; j < sums.size(); ++j) put_couple(static_cast<int>(j), sums[j]);
  }

 private:
  static constexpr int places = std::is_same_v<Row, Number> ? 1 : 2;

  /// Puts what acts on a joint into its place of a row. A row without couples is left out.
  void put_couple(int joint, const CoupleOf<AlongNames>& one) {
    bool is_there = false;
    each_field(one, one, [&](const AlongNames& x, const AlongNames&) { is_there |= !is_zero(x); });
    if (!is_there) return;
    auto found = std::ranges::find(couples, joint / places, &Couples<Row>::row);
    if (found == couples.end()) found = couples.insert(found, {.row = joint / places});
    each_field(*found, one, [&](Row& row, const AlongNames& x) {
      if constexpr (places == 1) {
        row = x;
      } else {
        set_number(row, joint % places, x);
      }
    });
    found->has_powers |= !is_zero(one.on_phid2) || !is_zero(one.on_phid3);
  }
};

}  // namespace pendcore
