/// \file
/// The kinks of the air's drag (dynamics/ends_in_air.hpp) along the dense output of a step.
#pragma once

#include <vector>

#include "dynamics/ends_in_air.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

/// The shares of a step from t_start at which there are kinks, in their order. Two of one end
/// between neighbouring samples are not seen. Cost: nine states of the dense output, and some fifty
/// for each kink; none in a scene without drag.
std::vector<double> kinks_of_drag(const EndsInAir<double>& air, const WatchedStep& step,
                                  double t_start);

}  // namespace pendcore
