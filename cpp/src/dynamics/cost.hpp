/// \file
/// The cost of a right-hand side of a scene, and what each of its effects adds: nanoseconds
/// measured on this machine, and operations counted by running the laws on a number type that
/// counts.
///
/// A measurement is the minimum over several rounds in which all contenders take turns. It takes
/// about 0.05 s, and depends on the machine and on its load.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pendcore/scene.hpp"

namespace pendcore {

struct Cost {
  std::string what;  ///< "links", "effect 1 (viscous_joint)", ..., "all"
  double nanoseconds;
  /// The number of additions, multiplications, fused pairs of them, and divisions in an effect; it
  /// is unknown for a user's function.
  std::optional<int> operations;
};

/// The cost of the links alone, what each effect adds to the links on its own, and the cost of the
/// whole scene.
std::vector<Cost> costs(const Scene& scene);

}  // namespace pendcore
