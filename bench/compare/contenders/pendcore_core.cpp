// pendcore's own core as a C++ user calls it: pendcore::simulate, states at the given times, result
// object included.
#include <cstddef>
#include <pendcore/pendcore.hpp>
#include <utility>
#include <vector>

#include "contender.hpp"

namespace contenders {
namespace {

class CoreRun : public Run {
 public:
  CoreRun(const Case& given, double tolerance)
      : t0_(given.times.front()), t_end_(given.times.back()) {
    const std::size_t n = given.masses.size();
    for (std::size_t i = 0; i < n; ++i)
      scene_.links.push_back(pendcore::Link::uniform_rod(given.masses[i], given.lengths[i]));
    scene_.gravity = given.gravity;
    const auto middle = given.start.begin() + static_cast<std::ptrdiff_t>(n);
    q0_.assign(given.start.begin(), middle);
    qd0_.assign(middle, given.start.end());
    options_.method = "dopri5";
    options_.rtol = options_.atol = {tolerance};
    options_.t_eval = given.times;
    options_.store = pendcore::Store::times;
  }
  void solve() override {
    solution_ = pendcore::simulate(scene_, q0_, qd0_, t0_, t_end_, options_);
  }
  std::span<const double> states() const override {
    if (solution_.status != pendcore::Status::finished) return {};
    return solution_.states;
  }
  long long evaluations() override { return solution_.statistics.nfev; }

 private:
  pendcore::Scene scene_;
  std::vector<double> q0_, qd0_;
  double t0_, t_end_;
  pendcore::Options options_;
  pendcore::Solution solution_;
};

}  // namespace

Contender pendcore_core() {
  return {"pendcore_cpp", "pendcore dopri5, C++",
          "pendcore::simulate, method dopri5, " CONTENDER_BUILD,
          [](const Case& given, double tolerance) {
            return std::make_unique<CoreRun>(given, tolerance);
          }};
}

}  // namespace contenders
