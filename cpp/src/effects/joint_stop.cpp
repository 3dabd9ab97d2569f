#include "pendcore/effects/joint_stop.hpp"

#include <stdexcept>

#include "effects/behaviour.hpp"

#include "text/message.hpp"

namespace pendcore {
namespace {

/// The equations of motion know the stops of a scene by their parameters.
class JointStopBehaviour final : public EffectOf<JointStop> {
 public:
  using EffectOf::EffectOf;

 private:
  void check_together(const std::string& where) const override {
    const auto [lower, upper] = given_.range;
    if (lower < upper && (lower > -never || upper < never)) return;
    throw std::invalid_argument(
        where + "range = (" + text(lower) + ", " + text(upper) +
        "): must be (lo, hi) with lo < hi, at least one of them finite (rad)");
  }
};

}  // namespace

std::shared_ptr<const EffectBehaviour> behaviour(JointStop given) {
  return std::make_shared<JointStopBehaviour>(given);
}

}  // namespace pendcore
