#include "pendcore/effects/viscous_joint.hpp"

#include "effects/behaviour.hpp"

namespace pendcore {
namespace {

class ViscousJointBehaviour final : public EffectOf<ViscousJoint> {
 public:
  using EffectOf::EffectOf;

  std::optional<Couple> couple(int mode) const override {
    return Couple{.on_phid = -given_.damping,
                  .on_phid2 = -mode * given_.damping2,
                  .on_phid3 = -given_.damping3};
  }

  bool has_modes() const override { return given_.damping2 != 0.0; }
  int mode_at(double /*t*/, double /*phi*/, double phid, bool /*forward*/) const override {
    return phid < 0.0 ? -1 : 1;
  }
  std::vector<Guard> guards(int mode) const override {
    return {{.on_phid = static_cast<double>(mode)}};
  }
  int next_mode(int mode, std::size_t /*guard*/) const override { return -mode; }

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
