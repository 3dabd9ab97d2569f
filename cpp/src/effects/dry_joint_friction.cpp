#include "pendcore/effects/dry_joint_friction.hpp"

#include "effects/behaviour.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

class DryJointFrictionBehaviour final : public EffectOf<DryJointFriction> {
 public:
  using EffectOf::EffectOf;

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

  bool has_modes() const override { return true; }
  int mode_at(double /*t*/, double /*phi*/, double phid, bool /*forward*/) const override {
    return phid < 0.0 ? -1 : 1;
  }
  std::vector<Guard> guards(int mode) const override {
    return {{.on_phid = static_cast<double>(mode)}};
  }
  int next_mode(int mode, std::size_t /*guard*/) const override { return -mode; }

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
