// Taylor series of every form of the equations of motion that has them.
#include <stdexcept>

#include "dynamics/equations_of_motion.hpp"
#include "dynamics/series/few_links_series.hpp"
#include "dynamics/series/series_with_holds.hpp"
#include "integrate/taylor/taylor_stepper.hpp"
#include "scene/effects_of_scene.hpp"
#include "simulate/steppers.hpp"

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
    return ChainSeries<Row>(ConstantsOfChain<double>(scene),
                            std::dynamic_pointer_cast<const EffectsInRows<Row>>(equations.effects));
  };
  if (auto bare = bare_series(equations)) return of(*std::move(bare));
  const auto& effects = equations.effects;
  if (auto free = series_with_torque(equations)) {
    if constexpr (has_special_kernels_of_rare_runs) {
      if (!equations.may_have_held_joints() && instruction_set() >= free->sets.least)
        return of(*std::move(free));
    }
    return of(SeriesWithHolds(*std::move(free), chain.template operator()<Pair>(), effects));
  }
  if (FewLinksSeries::has(scene, equations)) {
    auto rows = std::dynamic_pointer_cast<const EffectsInRows<Pack<4>>>(effects);
    return of(FewLinksSeries(scene, std::move(rows)));
  }
  return with_row_for(scene.links.size(),
                      [&]<class Row>() { return of(chain.template operator()<Row>()); });
}

}  // namespace pendcore
