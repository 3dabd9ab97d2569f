#include "dynamics/series/few_links_series.hpp"

#include <algorithm>
#include <utility>

#include "pendcore/effects/rotor_inertia.hpp"

namespace pendcore {

template <int links>
ConstantsOfFewLinks<double, links> constants_of_few_links(const Scene& scene) {
  const Inertia inertia(scene);
  ConstantsOfFewLinks<double, links> constants{};
  std::ranges::copy(chain_links(scene, inertia), constants.link);
  constants.payload_mass = inertia.payload_mass;
  for (int i = 0; i < links; ++i) {
    constants.weight[i] = scene.gravity * inertia.links[i].first_moment;
    for (int by = 1; by < links; ++by) {
      constants.coupling[by][i] = inertia.coupling(i, (i + by) % links);
    }
  }
  return constants;
}

template ConstantsOfFewLinks<double, 3> constants_of_few_links<3>(const Scene& scene);
template ConstantsOfFewLinks<double, 4> constants_of_few_links<4>(const Scene& scene);

bool FewLinksSeries::has(const Scene& scene, const EquationsOfMotion& equations) {
  const std::size_t n = scene.links.size();
  if ((n != 3 && n != 4) || !equations.effects) return false;
  const EffectsOfRun& effects = *equations.effects;
  const auto couples_links = [](const RotorInertia& rotor) { return rotor.joint > 1; };
  return !equations.may_have_held_joints() && effects.pivots.empty() && effects.waves <= 2 &&
         std::ranges::none_of(effects_of<RotorInertia>(scene), couples_links);
}

FewLinksSeries::FewLinksSeries(const Scene& scene, Effects effects)
    : effects_(is_bare(scene) ? nullptr : std::move(effects)),
      links_(static_cast<int>(scene.links.size())) {
  if (links_ == 3) three_ = constants_of_few_links<3>(scene);
  if (links_ == 4) four_ = constants_of_few_links<4>(scene);
}

}  // namespace pendcore
