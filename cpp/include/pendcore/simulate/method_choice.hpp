/// \file
/// The method of a run that names none, `"auto"`: a rule of the scene and the tolerances, so that
/// the same scene is run by the same method wherever it starts and ends.
///
///     dopri5          fixed steps, whatever the tolerances, which have no say in them
///     taylor-radau5   else two links or more, where every effect has a Taylor series
///     dop853-radau5   else, where of any component max(rtol, atol) is below 1e-6
///     dopri5-radau5   else
///
/// The pairs change over to radau5 where that pays, at whatever time (stiff_switching.hpp).
/// docs/accuracy_cost.md has what the rule is taken from.
#pragma once

#include <string_view>

#include "pendcore/scene/scene.hpp"
#include "pendcore/simulate/options.hpp"

namespace pendcore {

/// The name of the method, or of the one that the rule gives for `"auto"`. The scene and the
/// options are checked ones.
std::string_view chosen_method(const Scene& scene, const Options& options);

}  // namespace pendcore
