// Taylor series of every form of the equations of motion that has them.
#include <stdexcept>
#include <string>

#include "pendcore/dynamics/equations_of_motion.hpp"
#include "pendcore/dynamics/series/series_with_holds.hpp"
#include "pendcore/integrate/taylor/taylor_stepper.hpp"
#include "pendcore/simulate/simulate.hpp"

namespace pendcore {

namespace {

void check_series(const Scene& scene) {
  const std::optional<std::size_t> i = without_series(scene);
  if (!i) return;
  throw std::invalid_argument("method = \"taylor\": " + effect_name(scene, *i) +
                              " has no Taylor series: choose \"dop853\", or \"auto\"");
}

}  // namespace

std::unique_ptr<Stepper> make_taylor_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                             Rates rates, int quadratures, bool compensated) {
  check_series(scene);
  auto of = [&]<class Series>(Series series) -> std::unique_ptr<Stepper> {
    return std::make_unique<Taylor<Series>>(std::move(series), std::move(rates), quadratures,
                                            compensated);
  };
  auto chain = [&]<class Row>() {
    return ChainSeries<Row>(scene,
                            std::dynamic_pointer_cast<const ActingEffects<Row>>(equations.effects));
  };
  if (const auto* bare = std::get_if<DoublePendulum>(&equations.form)) {
    return of(DoublePendulumSeries<NoTorque>(
        {bare->weight, bare->coupling, Pair{}, bare->product, bare->delta, 0.0}, {}));
  }
  auto with_torque = [&]<Parts parts>(const DoublePendulumWithEffects<parts>& one) {
    auto effects = std::dynamic_pointer_cast<const ActingEffects<Pair>>(equations.effects);
    const DoublePendulumSeries<CoupleTorque> free(
        {one.weight, one.coupling, one.rotor, one.product, one.delta, one.epsilon},
        CoupleTorque(std::move(effects), one.inverse_diagonal));
    const bool may_hold = equations.held_joints->can_hold() || equations.effects->any_held;
    if constexpr (has_special_kernels_of_rare_runs) {
      if (!may_hold && instruction_set() >= free.least) return of(free);
    }
    return of(SeriesWithHolds(free, chain.template operator()<Pair>(), equations.effects));
  };
  if (const auto* one = std::get_if<DoublePendulumWithEffects<Parts::couples>>(&equations.form)) {
    return with_torque(*one);
  }
  const auto* one = std::get_if<DoublePendulumWithEffects<Parts::waves>>(&equations.form);
  if (one != nullptr && equations.effects->pivots.empty()) return with_torque(*one);
  switch (scene.links.size()) {
    case 1: return of(chain.template operator()<double>());
    case 2: return of(chain.template operator()<Pair>());
    default: return of(chain.template operator()<Pack<4>>());
  }
}

}  // namespace pendcore
