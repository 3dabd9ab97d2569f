/// \file
/// What a continued run needs to know of the laws in force.
#pragma once

#include <vector>

#include "dynamics/contact/held_joints.hpp"
#include "simulate/impacts.hpp"
#include "simulate/modes.hpp"

namespace pendcore {

/// The sizes are those of a scene with m effects and n links.
struct SwitchingState {
  std::vector<int> modes;  ///< (m)
  ChangesAtOnce changes;
  ImpactOrder impacts;
  std::vector<SavedHold> holds;     ///< (n)
  bool has_failed = false;          ///< whether a contact had no finite solution
  std::vector<int> multiplicities;  ///< of zeros at the start, one for each linear guard
};

std::vector<double> numbers_of(SwitchingState state);

/// Takes a state of m effects and n links out of its numbers. They may come from a damaged file:
/// throws std::invalid_argument if there are too few, or one is out of its range.
SwitchingState switching_state(const std::vector<double>& numbers, std::size_t m, std::size_t n);

void require_modes_fit(bool fits);

}  // namespace pendcore
