/// \file
/// The numbers of a scene by name: "gravity", "link[1].mass", "effect[2].wind.x". Links and effects
/// count from 1. Sweeps and ensembles vary a scene by these names.
///
/// A link that is a uniform rod stays one when its mass or length changes, unless its centre or its
/// inertia is given, too.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pendcore/scene.hpp"

namespace pendcore {

struct NamedNumber {
  std::string name;
  std::string unit;  ///< SI; empty for a pure number
  double value;
};

/// Every number that can be varied, gravity first, then links and effects from the pivot outwards.
/// Numbers that are left out of an effect, and those of tables and splines, are not among them.
std::vector<NamedNumber> parameters(const Scene& scene);

/// A choice of parameters of a scene, which are found by name once and set often.
class ParameterChoice {
 public:
  /// Throws std::invalid_argument for a name that the scene does not have, and says what may be
  /// meant: a parameter, or one of `others`, names that are known besides.
  ParameterChoice(const Scene& scene, const std::vector<std::string>& names,
                  const std::vector<std::string>& others = {});

  std::size_t size() const { return places_.size(); }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<double>& values() const { return values_; }  ///< those of the scene

  /// Sets the chosen parameters of a copy of the scene, in the order of the names. The result is
  /// not checked.
  void set(Scene& copy, std::span<const double> values) const;
  /// A copy of the scene in which the chosen parameter `which` has another value.
  Scene changed(const Scene& scene, std::size_t which, double value) const;

 private:
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<std::size_t> places_;  ///< in the order of parameters()
};

/// The names of inputs: "torque[j]" of each joint, "pivot.x" and "pivot.y".
std::vector<std::string> input_names(const Scene& scene);

}  // namespace pendcore
