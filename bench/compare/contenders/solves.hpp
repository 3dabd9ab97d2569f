// Contenders that solve cases. Beside the chain of rods, a case has its start, q_1..q_n and
// qd_1..qd_n, its times, which increase, and a setting: a tolerance, both relative and absolute, or
// a fixed step in s. The torque -stiffness (phi - rest) - damping dphi/dt acts in joint j, which is
// given both by these numbers and as pendcore's effects.
#pragma once

#include <span>
#include <utility>

#include "program.hpp"

namespace contenders {

// The cost of one solve: right-hand sides and attempted steps; < 0 if they are not counted.
struct Counts {
  long long evaluations = -1, steps = -1;
};

// `solve` is timed; states, counts and the failure may be asked for afterwards. The outcome has the
// counts and then the states, row-major, times x 2n; or it is `failed` and the reason.
class Run : public Prepared {
 public:
  void make(int count) final {
    for (; count > 0; --count) solve();
  }
  std::string outcome() final {
    solve();
    const auto found = states();
    if (found.empty()) return "failed " + failure();
    const Counts counted = counts();
    return std::to_string(counted.evaluations) + ' ' + std::to_string(counted.steps) +
           words({found.begin(), found.end()});
  }

  virtual void solve() = 0;
  virtual std::span<const double> states() const = 0;  // empty if the solve failed
  virtual Counts counts() = 0;
  virtual std::string failure() const { return "it did not reach the end"; }
};

}  // namespace contenders
