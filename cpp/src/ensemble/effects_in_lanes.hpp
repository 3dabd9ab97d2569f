/// \file
/// The effects of several trajectories, one in each lane, for the equations that take them as they
/// take EffectsInRows. Their laws never change, and have the same kinds in all lanes
/// (EffectsOfRun::kinds).
#pragma once

#include <algorithm>
#include <variant>
#include <vector>

#include "arithmetic/row_of_links.hpp"
#include "dynamics/effects_in_rows.hpp"

namespace pendcore {

/// How many links a row in lanes has: a pack is of one link.
template <class Row>
constexpr int links_in_row = Lanes<Row>::width > 1 ? 1 : count_of_numbers<Row>;

/// Puts the numbers of one trajectory, from `first` on, into a lane of a row.
template <class Row, class One>
void put_number(Row& all, int lane, const One& one, int first = 0) {
  for (int i = 0; i < links_in_row<Row>; ++i) {
    const double x = pendcore::lane(one, first + i);
    if constexpr (Lanes<Row>::width > 1) {
      all[lane] = x;
    } else {
      auto of_link = number_of(all, i);
      of_link[lane] = x;
      set_number(all, i, of_link);
    }
  }
}
/// Puts the constants of one trajectory into a lane.
template <class Constants, class One>
void put_constants(Constants& constants, int lane, const One& one) {
  each_field(constants, one,
             [lane](auto& all, const auto& of_one) { put_number(all, lane, of_one); });
}

/// `AnyRow` is as many packs as a row has links, or the pack of one link.
template <class AnyRow, class Real>
class EffectsInLanes : public Drives<Real> {
 public:
  using Row = AnyRow;
  using Number = Real;
  /// Drag is the only law but couples that never changes.
  using Entry = SharedLaw<RodDragLaw, Row>;

  static constexpr bool any_held = false;
  struct NoneIsHeld {
    constexpr bool operator[](int /*joint*/) const { return false; }
  };
  static constexpr NoneIsHeld held{};

  bool has_forces = false;
  bool are_couples_alone = false;
  std::vector<Couples<Row>> couples;
  std::vector<Entry> entries;
  WavesOf<Row> two_waves;  ///< if a row has two links

  /// Whether the effects of a trajectory have lanes.
  template <class RowOfRun>
  static bool has(const EffectsInRows<RowOfRun>& effects) {
    const auto is_drag = [](const auto& entry) {
      return std::holds_alternative<const SharedLaw<RodDragLaw, RowOfRun>*>(entry.law);
    };
    return effects.users.empty() && std::ranges::all_of(effects.entries, is_drag);
  }

  bool are_any() const { return are_any_; }

  template <class At, class Loads>
  PENDCORE_INLINE static void add(const Entry& entry, const At& at, Loads& loads) {
    entry.law.add(at, loads);
  }
  template <class At, class Loads>
  PENDCORE_INLINE static void add_all(const EffectsInLanes* effects, const At* at, Loads* loads) {
    for (const Entry& entry : effects->entries) add(entry, *at, *loads);
  }

  /// Makes room for effects of the kinds of a trajectory of `links` links.
  template <class RowOfRun>
  void prepare(const EffectsInRows<RowOfRun>& one, int links) {
    are_any_ = true;
    links_ = links;
    has_forces = one.has_forces;
    are_couples_alone = one.are_couples_alone;
    this->make_room_for_waves(one.waves);
    for (const JointWave& wave : one.joint_waves) {
      this->joint_waves.push_back({wave.joint, wave.wave, Real{}});
    }
    for (const PivotLaw& law : one.pivots) {
      PivotLawOf<Real>& in_lanes = this->pivots.emplace_back();
      in_lanes.x.wave = law.x.wave;
      in_lanes.y.wave = law.y.wave;
    }
    for (const Couples<RowOfRun>& of_row : one.couples) {
      each_row(of_row, [&](int row, int /*first*/) {
        couples.push_back({.row = row, .has_powers = of_row.has_powers});
      });
    }
    entries.resize(one.entries.size());
  }

  /// Puts the numbers of a trajectory into a lane.
  template <class RowOfRun>
  void put(int lane, const EffectsInRows<RowOfRun>& one) {
    for (int k = 0; k < this->waves; ++k) {
      this->angular_frequency.put(k, lane, one.angular_frequency[k]);
      this->phase.put(k, lane, one.phase[k]);
    }
    for (std::size_t i = 0; i < one.joint_waves.size(); ++i) {
      put_number(this->joint_waves[i].gain, lane, one.joint_waves[i].gain);
    }
    for (std::size_t i = 0; i < one.pivots.size(); ++i) {
      put_constants(this->pivots[i], lane, one.pivots[i]);
    }
    auto in_lanes = couples.begin();
    for (const Couples<RowOfRun>& of_row : one.couples) {
      each_row(of_row, [&](int /*row*/, int first) {
        each_field(*in_lanes++, of_row,
                   [&](Row& all, const RowOfRun& of_one) { put_number(all, lane, of_one, first); });
      });
    }
    if constexpr (places == 2) put_constants(two_waves, lane, one.two_waves);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      using Of = const SharedLaw<RodDragLaw, RowOfRun>*;
      put_constants(entries[i].law, lane, std::get<Of>(one.entries[i].law)->law);
    }
  }

 private:
  static constexpr int places = links_in_row<Row>;

  /// Calls use(row, first) for each row in lanes that a row of a run has joints of, and the first
  /// of these joints in the row of the run.
  template <class RowOfRun, class Use>
  void each_row(const Couples<RowOfRun>& of_row, const Use& use) const {
    constexpr int width = Lanes<RowOfRun>::width;
    for (int i = 0; i + places <= width && of_row.row * width + i < links_; i += places) {
      use((of_row.row * width + i) / places, i);
    }
  }

  bool are_any_ = false;
  int links_ = 0;
};

}  // namespace pendcore
