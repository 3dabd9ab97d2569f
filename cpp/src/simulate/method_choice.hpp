/// \file
/// The method of a run that leaves it to `"auto"`. The rule depends on the scene, the tolerances
/// and whether steps are fixed, so that the same scene is run by the same method wherever it starts
/// and ends.
///
///     dopri5          for fixed steps, which tolerances do not affect
///     taylor-radau5   else for two links or more, if every effect has a Taylor series
///     dop853-radau5   else if max(rtol, atol) of any component is below 1e-6
///     dopri5-radau5   else
///
/// The pairs change to radau5 where that is faster, at any time (stiff_switching.hpp).
/// docs/background/accuracy_cost.md has the measurements behind the rule.
#pragma once

#include <string_view>

#include "pendcore/options.hpp"
#include "pendcore/scene.hpp"

namespace pendcore {

/// The name of the method, or for `"auto"` the name of the method that the rule gives. The scene
/// and the options must have passed check().
std::string_view chosen_method(const Scene& scene, const Options& options);

}  // namespace pendcore
