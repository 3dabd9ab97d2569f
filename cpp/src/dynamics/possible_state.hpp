/// \file
/// The states that stops and locks allow.
#pragma once

#include <span>

#include "pendcore/scene.hpp"

namespace pendcore {

/// Angles or rates, and what messages call them.
struct NamedNumbers {
  const char* name;
  std::span<const double> numbers;
};

/// Throws std::invalid_argument for angles (rad) beyond a stop, or not those of a lock, and for
/// rates (rad/s) of locked joints, (n) each.
void require_possible(const Scene& scene, const NamedNumbers& q, const NamedNumbers& qd);

}  // namespace pendcore
