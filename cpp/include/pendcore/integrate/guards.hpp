/// \file
/// Where along an attempted step the law changes: the guards of Breaks, on the dense output.
#pragma once

#include "pendcore/integrate/breaks.hpp"
#include "pendcore/integrate/stepper.hpp"

namespace pendcore {

/// The first guard that the attempted step would make negative, and where in the step; none: -1.
struct Crossing {
  int guard = -1;
  double theta = 2.0;
};

class Guards {
 public:
  Guards(const Stepper& stepper, const Breaks& breaks);

  /// In the attempted step of size h.
  Crossing first(double h);

  /// By how much the step's end misses the zero of guard k, in units of the step.
  double miss(int k, double h);

 private:
  const Stepper& stepper_;
  const Breaks& breaks_;
  int dimension_;
  int degree_;
  std::vector<double> rows_;  ///< the dense output of the step
  std::vector<double> state_;
  std::vector<double> polynomial_;  ///< of a guard, in theta
};

}  // namespace pendcore
