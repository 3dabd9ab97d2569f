/// \file
/// What ends a run early: an exception of a user's function, the wall clock, and the monitor.
#pragma once

#include <chrono>
#include <exception>
#include <new>

#include "integrate/loop/integrate.hpp"

namespace pendcore {

/// Thrown out of work that is not done in steps; says why the run is to end. WebAssembly is
/// compiled without handlers, so that nothing may throw it there.
struct Stopped : std::exception {
  explicit Stopped(Status why) : status(why) {}
  Status status;
};
#if defined(__wasm__)
inline constexpr bool stopped_is_caught = false;
#else
inline constexpr bool stopped_is_caught = true;
#endif

/// What ended a part of a run before it was done; `status` is finished if nothing did.
struct Interruption {
  Status status = Status::finished;
  std::exception_ptr error = nullptr;  ///< what a user's function threw
};

/// Does a part of a run that may be stopped, or call users' functions.
template <class Work>
Interruption interruption_of(const Work& work) {
  try {
    work();
    return {};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Stopped& stopped) {
    return {.status = stopped.status};
  } catch (...) {  // an exception of a user's function
    return {.status = Status::callback_error, .error = std::current_exception()};
  }
}

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
