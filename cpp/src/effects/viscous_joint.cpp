#include "pendcore/effects/viscous_joint.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {
namespace {

class ViscousJointBehaviour final : public EffectWithSides<ViscousJoint> {
 public:
  using EffectWithSides::EffectWithSides;

  std::optional<Couple> couple(int mode) const override {
    return Couple{.on_phid = -given_.damping,
                  .on_phid2 = -mode * given_.damping2,
                  .on_phid3 = -given_.damping3};
  }

  bool has_modes() const override { return given_.damping2 != 0.0; }

  std::vector<std::string> warnings() const override {
    if (given_.damping >= 0 && given_.damping2 >= 0 && given_.damping3 >= 0) return {};
    return {"a negative damping coefficient feeds energy into the motion"};
  }
};

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(ViscousJoint given) {
  return std::make_shared<ViscousJointBehaviour>(given);
}

}  // namespace pendcore
