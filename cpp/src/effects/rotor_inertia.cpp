#include "pendcore/effects/rotor_inertia.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {

std::shared_ptr<const EffectBehaviour> behaviour(RotorInertia given) {
  return std::make_shared<EffectOf<RotorInertia>>(given);
}

}  // namespace pendcore
