/// \file
/// Where the air's drag on a rod has a kink: where an end of the rod turns into the wind or out of
/// it, the speed across the rod changes its sign (RodDragLaw). The third derivative of the drag by
/// the time jumps there, and the second one of its slopes.
#pragma once

#include <vector>

#include "pendcore/scene.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

/// The shares of a step from t_start at which there are kinks, in their order. Two of one end
/// between neighbouring samples are not seen. Cost: nine states of the dense output, and some fifty
/// for each kink; none in a scene without drag.
std::vector<double> kinks_of_drag(const Scene& scene, const WatchedStep& step, double t_start);

}  // namespace pendcore
