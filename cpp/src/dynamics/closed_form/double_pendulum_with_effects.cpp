#include "dynamics/closed_form/double_pendulum_with_effects.hpp"

#include "effects/behaviour.hpp"
#include "pendcore/effects/rotor_inertia.hpp"

namespace pendcore {

namespace {

constexpr Couples<Pair> no_couples;

}  // namespace

template <class AnyEffects, Parts parts>
LoadedDoublePendulum<AnyEffects, parts>::LoadedDoublePendulum(const Scene& scene,
                                                              const Inertia& inertia,
                                                              const Effects* in_force)
    : couples(in_force->couples.empty() ? &no_couples : in_force->couples.data()),
      effects(in_force) {
  // Let A' be A without the rotor in joint 2. Then A_11 A_22 - (A_12 C - J)^2
  //   = (A'_11 A'_22 - A_12^2) + A_12^2 S^2 + J (A'_11 + A'_22 + 2 A_12 C),
  // a sum of positive terms.
  Scene without = scene;
  std::erase_if(without.effects, [](const Effect& effect) {
    return effect.is<RotorInertia>() && effect->joint() == 2;
  });
  const Inertia plain(without);
  const DoublePendulum bare(scene, plain);
  double share[2];  // A'/A
  for (int i = 0; i < 2; ++i) {
    length[i] = inertia.links[i].length;
    diagonal[i] = inertia.links[i].divisor();
    inverse_diagonal[i] = 1.0 / inertia.links[i].divisor();
    moment[i] = inertia.links[i].first_moment / inertia.links[i].divisor();
    share[i] = plain.links[i].diagonal / inertia.links[i].divisor();
    weight[i] = inertia.links[i].first_moment * scene.gravity / inertia.links[i].divisor();
    coupling[i] = inertia.coupling(0, 1) / inertia.links[i].divisor();
    rotor[i] = inertia.links[1].rotor / inertia.links[i].divisor();
    // A link without inertia has A = 1 here. As J = 1 takes that back, the pair has the inertia of
    // the other link alone.
    if (inertia.links[i].diagonal == 0.0) rotor[i] = 1.0;
  }
  product = coupling[0] * coupling[1];
  delta = bare.delta * share[0] * share[1] + rotor[1] * share[0] + rotor[0] * share[1];
  epsilon = coupling[0] * rotor[1] + coupling[1] * rotor[0];
}

// The kernels instantiate the rest.
#define PENDCORE_WITH_EFFECTS(parts)                                                      \
  template LoadedDoublePendulum<EffectsInRows<Pair>, Parts::parts>::LoadedDoublePendulum( \
      const Scene&, const Inertia&, const EffectsInRows<Pair>*);
PENDCORE_WITH_EFFECTS(couples)
PENDCORE_WITH_EFFECTS(waves)
PENDCORE_WITH_EFFECTS(laws)
PENDCORE_WITH_EFFECTS(everything)

}  // namespace pendcore
