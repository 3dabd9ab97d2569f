/// \file
/// What the rounding of the state leaves over, as compensated steps carry it along: a low part for
/// each component, so that y + low is the state to about 106 bits.
///
/// A component that something else than a step sets, as a joint's rate where it comes to rest, is
/// exactly what it is set to: its low part is dropped.
///
/// Sources: S. Gill, A process for the step-by-step integration of differential equations in an
/// automatic digital computing machine, Proc. Camb. Phil. Soc. 47 (1951); O. Moeller, Quasi
/// double-precision in floating point addition, BIT 5 (1965).
#pragma once

#include <stdexcept>
#include <vector>

namespace pendcore {

template <class Block, int blocks, bool kept>
struct Compensation {};

template <class Block, int blocks>
struct Compensation<Block, blocks, true> {
  Block before[blocks] = {};  ///< of y,
  Block after[blocks] = {};   ///< and of y_new
};

/// Whether a stepper's memory holds a low part: that of a run that took no step may be empty.
/// Throws std::invalid_argument if it is that of another state.
inline bool has_low_part(const std::vector<double>& memory, int dimension) {
  if (!memory.empty() && memory.size() != static_cast<std::size_t>(dimension)) {
    throw std::invalid_argument("what rounding left over in this solution is not of its state");
  }
  return !memory.empty();
}

}  // namespace pendcore
