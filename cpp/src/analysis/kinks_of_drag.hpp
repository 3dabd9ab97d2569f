/// \file
/// Where the air's drag on a rod has a kink: where an end of the rod turns into the wind or out of
/// it, the speed across the rod changes its sign (RodDragLaw). The third derivative of the drag by
/// the time jumps there, and the second one of its slopes.
#pragma once

#include <vector>

#include "pendcore/scene.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

class KinksOfDrag {
 public:
  explicit KinksOfDrag(const Scene& scene);

  /// The shares of a step from t_start at which there are kinks, in their order. Two of one end
  /// between neighbouring samples are not seen. Cost: nine states of the dense output, and some
  /// fifty for each kink; none in a scene without drag.
  std::vector<double> find(const WatchedStep& step, double t_start);

 private:
  void take_speeds(double t, const double* y, double* speeds) const;

  const Scene& scene_;
  int ends_;  ///< of all rods in air, of which each effect has two
  std::vector<double> thetas_, states_, speeds_;
};

}  // namespace pendcore
