/// \file
/// The rounding error of the state, which compensated steps carry along: a low part for each
/// component, so that y + low is the state to about 106 bits.
///
/// A component that is not set by a step, such as a joint's rate where it comes to rest, has
/// exactly the value that it is set to: its low part is dropped.
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
  Block before[blocks] = {};  ///< the low part of y
  Block after[blocks] = {};   ///< the low part of y_new
};

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
