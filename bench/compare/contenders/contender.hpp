// What a C++ contender of the comparison is. A program of contenders is solves.cpp with a file that
// defines `contenders`: to add one, write such a file and name it in ../CMakeLists.txt and in
// compiled.py.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "conversation.hpp"

namespace contenders {

// A chain of uniform rods: masses (kg), lengths (m), gravity (m/s^2). In joint j acts the torque
// -stiffness (phi - rest) - damping dphi/dt, which `controller` calls a motor's and not a spring's
// and a damper's. start = q_1..q_n, qd_1..qd_n; times rising.
struct Case {
  std::vector<double> masses, lengths;
  double gravity = 0;
  std::vector<double> damping, stiffness, rest;
  bool controller = false;
  std::vector<double> start, times;
};

// What one solve took: right-hand sides and attempted steps; < 0 where nobody counts.
struct Counts {
  long long evaluations = -1, steps = -1;
};

// A case at a setting: a tolerance, relative and absolute alike, or a fixed step in s. `solve` is
// what is timed; states, counts and what was said may be asked for afterwards.
class Run {
 public:
  virtual ~Run() = default;
  virtual void solve() = 0;
  virtual std::span<const double> states()
      const = 0;  // row-major, times x 2n; empty if the solve failed
  virtual Counts counts() = 0;
  virtual std::string failure() const { return "it did not reach the end"; }
};

// `label` names it in tables, `about` says version and settings. `prepare` builds all that can be
// built before the clock starts, and throws Unsupported for a case that it does not carry.
struct Contender {
  std::string name, label, about;
  std::function<std::unique_ptr<Run>(const Case&, double setting)> prepare;
};

std::vector<Contender> contenders();

}  // namespace contenders
