// pendcore's own core as a C++ user calls it: pendcore::simulate with states at the given times,
// including the result object.
#include <cstddef>

#include "arithmetic/instruction_set.hpp"
#include "pendcore_scene.hpp"
#include "solves.hpp"

namespace contenders {
namespace {

class CoreRun : public Run {
 public:
  CoreRun(const Given& given, const std::string& method)
      : scene_(scene_of(given)), t0_(given["times"].front()), t_end_(given["times"].back()) {
    const Numbers &start = given["start"], &setting = given["setting"];
    const auto middle = start.begin() + static_cast<std::ptrdiff_t>(given.n());
    q0_.assign(start.begin(), middle);
    qd0_.assign(middle, start.end());
    options_.method = method;
    if (options_.method == "rk4")
      options_.step = setting[0];
    else
      options_.rtol = options_.atol = setting;
    options_.t_eval = given["times"];
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
  Numbers q0_, qd0_;
  double t0_, t_end_;
  pendcore::Options options_;
  pendcore::Solution solution_;
};

Contender core(const std::string& method) {
  return {"pendcore_" + method + "_cpp", "pendcore " + method + ", C++",
          "pendcore::simulate, method " + method + ", " + name(pendcore::instruction_set()) +
              ", " CONTENDER_BUILD,
          [method](const Given& given) { return std::make_unique<CoreRun>(given, method); }};
}

}  // namespace

std::vector<Contender> contenders() {
  std::vector<Contender> all;
  for (const pendcore::MethodInfo* known : pendcore::methods())
    all.push_back(core(std::string(known->name)));
  return all;
}

}  // namespace contenders
