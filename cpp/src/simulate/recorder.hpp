/// \file
/// Records what the options ask for of each step, and the events that are found on the steps.
#pragma once

#include <optional>
#include <vector>

#include "integrate/loop/integrate.hpp"
#include "pendcore/solution.hpp"
#include "simulate/event_finder.hpp"
#include "simulate/step_watch.hpp"

namespace pendcore {

class Recorder final : public Observer {
 public:
  /// `passed_events` says of each event how many of its first occurrences do not end the run,
  /// because an earlier part of it ended there.
  Recorder(Solution& solution, const StepOutput& output, const Scene& scene,
           const std::vector<long long>& passed_events);

  void start(double t, const std::vector<double>& y);
  StepEnd step_accepted(StepOutput& output, const TwoDouble& t_old, double h,
                        double t_new) override;
  void state_jumped(double t, const double* before, const double* after) override;
  void state_settled(double t, const double* after) override;
  void restarts_here() override { solution_.resumable_kept = kept(); }
  void restarts_at_step() override { solution_.resumable_kept = at_step_start_; }
  bool may_end() const override { return may_throw_ || (finder_ && finder_->may_end()); }
  void step_begins() override { at_step_start_ = kept(); }
  bool has_ended() const override { return finder_ && finder_->ended_by() >= 0; }

  /// The event that ended the run; -1 if none did.
  int ended_by() const { return finder_ ? finder_->ended_by() : -1; }

 private:
  void interpolate(StepOutput& output, double h);  ///< sets polynomial_
  Solution::Kept kept() const;
  void sample_before(StepOutput& output, const TwoDouble& t_old, double h, double t_end);
  bool is_asked_for(double t) const;
  double* append(double t);  ///< returns memory for the state at t

  Solution& solution_;
  StepWatch* watch_;
  bool watch_asks_for_polynomials_;
  std::optional<EventFinder> finder_;
  bool may_throw_;  ///< whether there are users' functions
  Solution::Kept at_step_start_;
  bool keeps_polynomials_;
  bool keeps_steps_;
  std::size_t dimension_;
  std::size_t degree_;
  std::vector<double> polynomial_;  ///< the dense output of one step
  std::vector<double> shown_;       ///< the state that the watch sees
};

}  // namespace pendcore
