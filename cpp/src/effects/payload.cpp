#include "pendcore/effects/payload.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {

std::shared_ptr<const EffectBehaviour> behaviour(Payload given) {
  return std::make_shared<EffectOf<Payload>>(given);
}

}  // namespace pendcore
