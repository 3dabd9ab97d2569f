// What a C++ contender of the comparison is. To add one: a .cpp file that defines a function
// returning a Contender, its declaration here, and a line in the list of solves.cpp.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "conversation.hpp"

namespace contenders {

// A chain of uniform rods: masses (kg), lengths (m), gravity (m/s^2); start = q_1..q_n, qd_1..qd_n;
// times rising.
struct Case {
  std::vector<double> masses, lengths;
  double gravity = 0;
  std::vector<double> start, times;
};

// A case at a tolerance (relative and absolute alike). `solve` is what is timed; states and count
// may be asked for afterwards.
class Run {
 public:
  virtual ~Run() = default;
  virtual void solve() = 0;
  virtual std::span<const double> states()
      const = 0;                        // row-major, times x 2n; empty if the solve failed
  virtual long long evaluations() = 0;  // right-hand sides of one solve
};

// `label` names it in tables, `about` says version and settings. `prepare` builds all that can be
// built before the clock starts.
struct Contender {
  std::string name, label, about;
  std::function<std::unique_ptr<Run>(const Case&, double tolerance)> prepare;
};

Contender pendcore_core();
Contender odeint();

}  // namespace contenders
