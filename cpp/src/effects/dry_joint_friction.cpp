#include "pendcore/effects/dry_joint_friction.hpp"

#include "effects/behaviour.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

class DryJointFrictionBehaviour final : public EffectWithSides<DryJointFriction> {
 public:
  using EffectWithSides::EffectWithSides;

  /// Coulomb's law, if there is no static peak.
  std::optional<Couple> couple(int mode) const override {
    if (given_.peak() > 0) return {};
    return Couple{.held = -mode * given_.coulomb};
  }
  std::optional<AnyLaw> law(int mode, const LinkConstants& /*on*/) const override {
    return StribeckLaw<double>{.coulomb = mode * given_.coulomb,
                               .peak = mode * given_.peak(),
                               .inverse_velocity = mode / given_.stribeck_velocity,
                               .exponent = given_.exponent};
  }
  std::optional<double> holding_torque() const override {
    return given_.static_.value_or(given_.coulomb);
  }

 private:
  void check_together(const std::string& where) const override {
    if (!given_.static_ || given_.peak() >= 0) return;
    refuse(where + "static", *given_.static_,
           "at least coulomb = " + text(given_.coulomb) + " (N m)");
  }
};

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(DryJointFriction given) {
  return std::make_shared<DryJointFrictionBehaviour>(given);
}

}  // namespace pendcore
