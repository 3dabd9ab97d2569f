#include "pendcore/effects/effect.hpp"

#include <utility>

#include "effects/behaviour.hpp"

namespace pendcore {

Effect::Effect(std::shared_ptr<const EffectBehaviour> behaviour)
    : behaviour_(std::move(behaviour)),
      info_(&behaviour_->info()),
      parameters_(behaviour_->given()) {}

}  // namespace pendcore
