#include "pendcore/effects/rod_drag.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {
namespace {

class RodDragBehaviour final : public EffectOf<RodDrag> {
 public:
  using EffectOf::EffectOf;

  std::optional<AnyLaw> law(int /*mode*/, const LinkConstants& on) const override {
    const double k = given_.k();
    return RodDragLaw<double>{.minus_k = -k * on.length / 3.0,
                              .minus_k_arm = -k * on.length * on.length / 12.0,
                              .wind_x = given_.wind[0],
                              .wind_y = given_.wind[1]};
  }
  bool has_wind() const override { return given_.wind[0] != 0.0 || given_.wind[1] != 0.0; }
};

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(RodDrag given) {
  return std::make_shared<RodDragBehaviour>(given);
}

}  // namespace pendcore
