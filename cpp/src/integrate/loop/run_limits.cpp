#include "integrate/loop/run_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pendcore {
namespace {

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

}  // namespace

// To read the clock takes as long as three right-hand sides: a run of one step reads it once, and
// not at all where nothing waits for it.
RunLimits::RunLimits(const Limits& limits, double t0) : limits_(limits), t0_(t0) {
  const bool has_limit = std::isfinite(limits.time_limit);
  // Before the second step, no monitor waits yet.
  if (!has_limit) steps_between_looks_ = limits.monitor ? 2 : std::numeric_limits<int>::max();
  if (!has_limit && !limits.monitor) return;
  start_ = last_look_ = last_call_ = Steady::now();
}

Status RunLimits::look(double t) {
  if (++steps_ < steps_between_looks_) return Status::finished;
  steps_ = 0;
  const Steady::time_point now = Steady::now();
  const double since_look = seconds(now - last_look_);
  last_look_ = now;
  if (since_look < 0.5e-3) {
    steps_between_looks_ = std::min(2 * steps_between_looks_, 1 << 20);
  } else if (since_look > 2e-3) {
    steps_between_looks_ = std::max(steps_between_looks_ / 2, 1);
  }
  if (seconds(now - start_) >= limits_.time_limit) return Status::time_limit;
  if (limits_.monitor && seconds(now - last_call_) >= 0.05) {
    last_call_ = now;
    if (!limits_.monitor((t - t0_) / (limits_.t_end - t0_))) return Status::interrupted;
  }
  return Status::finished;
}

}  // namespace pendcore
