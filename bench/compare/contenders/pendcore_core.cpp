// pendcore's own core as a C++ user calls it: pendcore::simulate with states at the given times,
// including the result object.
#include <cstddef>
#include <pendcore/pendcore.hpp>
#include <utility>
#include <vector>

#include "arithmetic/instruction_set.hpp"
#include "solves.hpp"

namespace contenders {
namespace {

pendcore::Scene scene_of(const Case& given) {
  pendcore::Scene scene;
  scene.gravity = given.gravity;
  for (std::size_t i = 0; i < given.masses.size(); ++i) {
    scene.links.push_back(pendcore::Link::uniform_rod(given.masses[i], given.lengths[i]));
    const int joint = static_cast<int>(i) + 1;
    const double k = given.stiffness[i], b = given.damping[i], rest = given.rest[i];
    if (given.controller && (k != 0 || b != 0)) {
      const pendcore::PD pd{.kp = k, .kd = b, .reference = rest};
      scene.effects.emplace_back(pendcore::Motor{.joint = joint, .pd = pd});
      continue;
    }
    if (k != 0)
      scene.effects.emplace_back(
          pendcore::TorsionalSpring{.joint = joint, .stiffness = k, .rest_angle = rest});
    if (b != 0) scene.effects.emplace_back(pendcore::ViscousJoint{.joint = joint, .damping = b});
  }
  return scene;
}

class CoreRun : public Run {
 public:
  CoreRun(const Case& given, const char* method, double setting)
      : scene_(scene_of(given)), t0_(given.times.front()), t_end_(given.times.back()) {
    const auto middle = given.start.begin() + static_cast<std::ptrdiff_t>(given.masses.size());
    q0_.assign(given.start.begin(), middle);
    qd0_.assign(middle, given.start.end());
    options_.method = method;
    if (options_.method == "rk4")
      options_.step = setting;
    else
      options_.rtol = options_.atol = {setting};
    options_.t_eval = given.times;
    options_.store = pendcore::Store::times;
    options_.max_steps = 2'000'000;
  }
  void solve() override {
    solution_ = pendcore::simulate(scene_, q0_, qd0_, t0_, t_end_, options_);
  }
  std::span<const double> states() const override {
    if (solution_.status != pendcore::Status::finished) return {};
    return solution_.states;
  }
  Counts counts() override {
    const auto& counted = solution_.statistics;
    return {.evaluations = counted.nfev, .steps = counted.accepted + counted.rejected};
  }
  std::string failure() const override { return solution_.message; }

 private:
  pendcore::Scene scene_;
  std::vector<double> q0_, qd0_;
  double t0_, t_end_;
  pendcore::Options options_;
  pendcore::Solution solution_;
};

Contender core(const std::string& method) {
  return solver("pendcore_" + method + "_cpp", "pendcore " + method + ", C++",
                "pendcore::simulate, method " + method + ", " + name(pendcore::instruction_set()) +
                    ", " CONTENDER_BUILD,
                [method](const Case& given, double setting) {
                  return std::make_unique<CoreRun>(given, method.c_str(), setting);
                });
}

}  // namespace

std::vector<Contender> contenders() {
  std::vector<Contender> all;
  for (const pendcore::MethodInfo* known : pendcore::methods())
    all.push_back(core(std::string(known->name)));
  return all;
}

}  // namespace contenders
