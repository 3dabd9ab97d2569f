/// \file
/// The equations that Runge-Kutta methods take in lanes: those of a run, on packs with a
/// trajectory, and its constants, in each lane. Three and four links are in few_links_in_lanes.hpp.
///
/// All equations in lanes, these and the series of series_equations.hpp, have
///
///     has(scene, equations)      whether a trajectory has this form; another one of the same
///                                kind (kinds_of) has it, too
///     prepare(scene, equations)  makes room for trajectories like this one; from then on, the form
///                                stays where it is
///     put(lane, scene, equations)  puts the constants of a trajectory into a lane
///     drives()                   what moves the pivot; null without effects
///
/// and those of Runge-Kutta methods `is_called`: whether a step calls them (CalledEquations); if
/// not, they are written into it; and `may_have_drag`.
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "dynamics/equations_of_motion.hpp"
#include "ensemble/effects_in_lanes.hpp"

namespace pendcore {

/// What trajectories must have in common to share lanes.
inline std::vector<int> kinds_of(const EquationsOfMotion& equations) {
  std::vector<int> kinds;
  if (equations.effects) kinds = equations.effects->kinds();
  kinds.push_back(static_cast<int>(equations.form.index()));
  kinds.push_back(int{equations.are_steady()});
  const auto* const chain = std::get_if<std::shared_ptr<Chain>>(&equations.form);
  if (chain != nullptr) kinds.push_back(int{(*chain)->has_rotors()});
  return kinds;
}

/// Calls use<Form>() with the first of these forms that a trajectory has. Returns whether there is
/// one.
template <class Form, class... Others, class Use>
bool with_first_form(const Scene& scene, const EquationsOfMotion& equations, const Use& use) {
  if (Form::has(scene, equations)) {
    use.template operator()<Form>();
    return true;
  }
  if constexpr (sizeof...(Others) > 0) return with_first_form<Others...>(scene, equations, use);
  return false;
}

/// The effects of one trajectory, which are compiled for rows of this type.
template <class RowOfRun>
const EffectsInRows<RowOfRun>& effects_on(const EquationsOfMotion& equations) {
  return dynamic_cast<const EffectsInRows<RowOfRun>&>(*equations.effects);
}

/// One link, bare or with effects.
template <class Real, bool couples_alone>
struct OneLinkInLanes
    : LoadedSinglePendulum<EffectsInLanes<EachLink<Real, 1>, Real>, couples_alone> {
  static constexpr bool is_called = !couples_alone;
  static constexpr bool may_have_drag = !couples_alone;

  static bool has(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    if (std::holds_alternative<SinglePendulum>(equations.form)) return couples_alone;
    if (!std::holds_alternative<SinglePendulumWithEffects>(equations.form)) return false;
    const EffectsInRows<double>& effects = effects_on<double>(equations);
    return equations.are_steady() && effects.are_couples_alone == couples_alone &&
           EffectsInLanes<EachLink<Real, 1>, Real>::has(effects);
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& one) {
    this->effects = &in_lanes;
    if (one.effects) in_lanes.prepare(effects_on<double>(one), 1);
  }
  void put(int lane, const Scene& /*scene*/, const EquationsOfMotion& one) {
    if (const auto* const bare = std::get_if<SinglePendulum>(&one.form)) {
      put_number(this->weight, lane, bare->weight);
    } else {
      put_constants(*this, lane, std::get<SinglePendulumWithEffects>(one.form));
      in_lanes.put(lane, effects_on<double>(one));
    }
  }

  const Drives<Real>* drives() const { return &in_lanes; }

 private:
  EffectsInLanes<EachLink<Real, 1>, Real> in_lanes;
};

/// Two links without effects.
template <class Real>
struct TwoBareLinksInLanes : DoublePendulumEquations<Two<Real>, Real> {
  static constexpr bool is_called = false;
  static constexpr bool may_have_drag = false;

  static bool has(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    return std::holds_alternative<DoublePendulum>(equations.form);
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& /*one*/) {}
  void put(int lane, const Scene& /*scene*/, const EquationsOfMotion& one) {
    put_constants(*this, lane, std::get<DoublePendulum>(one.form));
  }
  const Drives<Real>* drives() const { return nullptr; }
};

/// Two links with effects. Each form of a run has its own in lanes, as one for all parts would take
/// up to a fifth longer: its loops over waves and laws part the registers of the equations.
template <class Real, Parts parts>
struct TwoLinksInLanes : LoadedDoublePendulum<EffectsInLanes<Two<Real>, Real>, parts> {
  static constexpr bool is_called = parts != Parts::couples;
  static constexpr bool may_have_drag = is_called;

  static bool has(const Scene& /*scene*/, const EquationsOfMotion& equations) {
    return std::holds_alternative<OfRun>(equations.form) && equations.are_steady() &&
           EffectsInLanes<Two<Real>, Real>::has(effects_on<Pair>(equations));
  }
  void prepare(const Scene& /*scene*/, const EquationsOfMotion& one) {
    this->effects = &in_lanes;
    in_lanes.prepare(effects_on<Pair>(one), 2);
    this->couples = in_lanes.couples.empty() ? &no_couples : in_lanes.couples.data();
  }
  void put(int lane, const Scene& /*scene*/, const EquationsOfMotion& one) {
    put_constants(*this, lane, std::get<OfRun>(one.form));
    in_lanes.put(lane, effects_on<Pair>(one));
  }

  const Drives<Real>* drives() const { return &in_lanes; }

 private:
  using OfRun = DoublePendulumWithEffects<parts>;

  EffectsInLanes<Two<Real>, Real> in_lanes;
  Couples<Two<Real>> no_couples;
};

}  // namespace pendcore
