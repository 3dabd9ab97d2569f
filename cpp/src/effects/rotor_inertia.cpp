#include "pendcore/effects/rotor_inertia.hpp"

#include "pendcore/effects/behaviour.hpp"

namespace pendcore {

std::shared_ptr<const EffectBehaviour> behaviour(RotorInertia given) {
  return std::make_shared<EffectOf<RotorInertia>>(given);
}

}  // namespace pendcore
