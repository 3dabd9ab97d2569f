#include "pendcore/effects/lock.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {

std::shared_ptr<const EffectBehaviour> behaviour(Lock given) {
  return std::make_shared<EffectOf<Lock>>(given);
}

}  // namespace pendcore
