#include "dynamics/series/double_pendulum_series.hpp"

namespace pendcore {

std::optional<DoublePendulumSeries<NoTorque>> bare_series(const EquationsOfMotion& equations) {
  const auto* const form = std::get_if<DoublePendulum>(&equations.form);
  if (form == nullptr) return std::nullopt;
  return DoublePendulumSeries<NoTorque>(
      {form->weight, form->coupling, Pair{}, form->product, form->delta, 0.0}, {});
}

std::optional<DoublePendulumSeries<CoupleTorque<Pair>>> series_with_torque(
    const EquationsOfMotion& equations) {
  std::optional<DoublePendulumSeries<CoupleTorque<Pair>>> found;
  const auto take = [&](const auto* form) {
    if (form == nullptr || !equations.effects->pivots.empty()) return;
    auto effects = std::dynamic_pointer_cast<const EffectsInRows<Pair>>(equations.effects);
    found.emplace(DoublePendulumConstants{form->weight, form->coupling, form->rotor, form->product,
                                          form->delta, form->epsilon},
                  CoupleTorque<Pair>{std::move(effects), form->inverse_diagonal});
  };
  take(std::get_if<DoublePendulumWithEffects<Parts::couples>>(&equations.form));
  take(std::get_if<DoublePendulumWithEffects<Parts::waves>>(&equations.form));
  return found;
}

}  // namespace pendcore
