/// \file
/// Keeps of the steps what the options ask for.
#pragma once

#include <vector>

#include "pendcore/solution.hpp"

namespace pendcore {

class Recorder final : public Observer {
 public:
  Recorder(Solution& solution, const Stepper& stepper);

  void start(double t, const std::vector<double>& y);
  double step_accepted(const Stepper& stepper, const TwoDouble& t_old, double h,
                       double t_new) override;
  void state_jumped(double t, const double* before, const double* after) override;
  void end_in_sight() override { count(); }

  /// What is kept so far is what an unstopped run has as well.
  void count();

 private:
  void sample_step(const Stepper& stepper, const TwoDouble& t_old, double h, double t_new);
  double* append(double t);  ///< room for the state at t

  Solution& solution_;
  bool keeps_polynomials_;
  bool keeps_steps_;
  std::size_t dimension_;
  std::vector<double> polynomial_;  ///< of one step
};

}  // namespace pendcore
