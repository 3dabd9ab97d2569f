/// \file
/// Explicit Runge-Kutta methods on a state of any size, in memory.
///
/// A step is the one of step.hpp, operation for operation, for a state or a system whose size the
/// compiler does not know: long chains, runs with quadratures beside the state, which do not count
/// in the error norm, and compensated runs.
#pragma once

#include <memory>
#include <string_view>

#include "integrate/general_system.hpp"
#include "integrate/stepper.hpp"

namespace pendcore {

/// The row of a system for n angles: numbers are worked on in packs of four. Runs that verify
/// others are compensated, and one or two links are then worth packs of their own width.
constexpr int row_in_memory(int n, bool compensated) {
  return compensated && n <= 2 ? n : (n + 3) / 4 * 4;
}

/// The stepper of an explicit method, by its name, for n angles of a system with rows of 1, of 2 or
/// of a multiple of 4 numbers.
std::unique_ptr<Stepper> runge_kutta_in_memory(std::string_view method,
                                               std::unique_ptr<GeneralSystem> system, int n,
                                               bool compensated = false);

}  // namespace pendcore
