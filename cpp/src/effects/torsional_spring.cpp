#include "pendcore/effects/torsional_spring.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {
namespace {

class TorsionalSpringBehaviour final : public EffectOf<TorsionalSpring> {
 public:
  using EffectOf::EffectOf;

  std::optional<Couple> couple(int /*mode*/) const override {
    return Couple{.held = given_.stiffness * given_.rest_angle, .on_phi = -given_.stiffness};
  }
  double potential(double phi) const override {
    const double stretch = phi - given_.rest_angle;
    return 0.5 * given_.stiffness * stretch * stretch;
  }
};

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(TorsionalSpring given) {
  return std::make_shared<TorsionalSpringBehaviour>(given);
}

}  // namespace pendcore
