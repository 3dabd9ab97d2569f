// Contenders that solve cases. A program of them defines `contenders` and is named in
// ../CMakeLists.txt and in compiled.py, which speaks to it:
//
//   prepare NAME SETTING n masses lengths gravity damping stiffness rest controller start n_t times
//   outcome RUN              right-hand sides, steps, then the states; or `failed` and the reason
//   burst RUN SECONDS        nanoseconds of each call; the first of several only warms up
#pragma once

#include <span>
#include <utility>

#include "conversation.hpp"

namespace contenders {

// A chain of uniform rods: masses (kg), lengths (m), gravity (m/s^2). The torque -stiffness
// (phi - rest) - damping dphi/dt acts in joint j. If `controller` is true it belongs to a motor,
// otherwise to a spring and a damper. start = q_1..q_n, qd_1..qd_n; times increase.
struct Case {
  std::vector<double> masses, lengths;
  double gravity = 0;
  std::vector<double> damping, stiffness, rest;
  bool controller = false;
  std::vector<double> start, times;
};

// The cost of one solve: right-hand sides and attempted steps; < 0 if they are not counted.
struct Counts {
  long long evaluations = -1, steps = -1;
};

// A case at a setting: a tolerance, both relative and absolute, or a fixed step in s. `solve` is
// timed; states, counts and the failure may be asked for afterwards.
class Run : public Prepared {
 public:
  std::string burst(double seconds) final;
  std::string tell(const std::string& word, std::istream& rest) final;

  virtual void solve() = 0;
  virtual std::span<const double> states()
      const = 0;  // row-major, times x 2n; empty if the solve failed
  virtual Counts counts() = 0;
  virtual std::string failure() const { return "it did not reach the end"; }
};

// `prepare` throws Unsupported for a case that the contender does not support.
using PrepareRun = std::function<std::unique_ptr<Run>(const Case&, double setting)>;
Contender solver(std::string name, std::string label, std::string about, PrepareRun prepare);

}  // namespace contenders
