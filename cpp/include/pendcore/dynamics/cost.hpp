/// \file
/// What a right-hand side of a scene costs, and what each of its effects adds: nanoseconds measured
/// here and now, and operations counted by running the laws on a number type that counts.
///
/// A measurement is the least of several rounds in which all contenders take turns. It takes about
/// 0.05 s and depends on the machine and on what else runs there.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pendcore/scene/scene.hpp"

namespace pendcore {

struct Cost {
  std::string what;  ///< "links", "effect 1 (viscous_joint)", ..., "all"
  double nanoseconds;
  /// Additions, multiplications, fused pairs of them, divisions; not known of a user's function.
  std::optional<int> operations;
};

/// What the links cost alone, what each effect adds to them on its own, what the whole scene costs.
std::vector<Cost> costs(const Scene& scene);

}  // namespace pendcore
