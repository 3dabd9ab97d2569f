/// \file
/// The rounding error of the state, which compensated steps carry along: a low part for each
/// component, so that y + low is the state to about 106 bits.
///
/// A compensated step forms the increment h sum b_k k on its own, on top of the low part of y, and
/// splits its sum with y without error. A component that something else than a step sets, as a
/// joint's rate where it comes to rest, is exactly what it is set to: its low part is dropped.
///
/// Sources: S. Gill, A process for the step-by-step integration of differential equations in an
/// automatic digital computing machine, Proc. Camb. Phil. Soc. 47 (1951); O. Moeller, Quasi
/// double-precision in floating point addition, BIT 5 (1965).
#pragma once

#include <stdexcept>
#include <vector>

#include "integrate/runge_kutta/step.hpp"

namespace pendcore {

/// y + (low + h sum b_k k), rounded; `after` becomes what that leaves over.
template <class Block, class Weights, class Stage>
PENDCORE_INLINE Block advance_compensated(const Block& y, const Block& low, double h,
                                          const Weights& weights, const Stage& k, int count,
                                          Block& after) {
  const Block increment = advance(low, h, weights, k, count);
  const Block sum = y + increment;
  after = left_over(y, increment, sum);
  return sum;
}

/// Drops the low part of those components that are no longer what they were.
inline void drop_changed(const double* y, const double* before, int count, double* low) {
  for (int i = 0; i < count; ++i) {
    if (y[i] != before[i]) low[i] = 0.0;
  }
}

/// Whether a stepper's memory has a low part; the memory of a run that took no step may be empty.
/// Throws std::invalid_argument if the memory belongs to another state.
inline bool has_low_part(const std::vector<double>& memory, int dimension) {
  if (!memory.empty() && memory.size() != static_cast<std::size_t>(dimension)) {
    throw std::invalid_argument(
        "the rounding errors kept in this solution do not belong to its state");
  }
  return !memory.empty();
}

}  // namespace pendcore
