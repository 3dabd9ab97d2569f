/// \file
/// What ends a run from outside: an exception of a user's function, such as that of an effect, and
/// the limits of a run (run_limits.hpp) in work that is not done in steps. The run keeps what it
/// has, and Solution::error is the exception.
#pragma once

#include <exception>
#include <new>

#include "pendcore/status.hpp"

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

}  // namespace pendcore
