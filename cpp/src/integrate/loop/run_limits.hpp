/// \file
/// The wall clock for the loop: when to stop, and when to report.
#pragma once

#include <chrono>

#include "integrate/loop/integrate.hpp"

namespace pendcore {

/// Looks at the clock seldom, but often enough: the time limit is kept within a few milliseconds,
/// and the monitor is called about every 50 ms.
class RunLimits {
 public:
  RunLimits(const Limits& limits, double t0);

  /// Status::finished means that the run goes on.
  Status look(double t);

 private:
  using Steady = std::chrono::steady_clock;

  const Limits& limits_;
  double t0_;
  int steps_ = 0;
  int steps_between_looks_ = 1;
  Steady::time_point start_{};
  Steady::time_point last_look_{};
  Steady::time_point last_call_{};
};

}  // namespace pendcore
