/// \file
/// Each lane has a Recorder, which looks at a step of the lane as it does at a step of a single
/// run.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "ensemble/lane_steps.hpp"
#include "ensemble/lanes.hpp"
#include "pendcore/solution.hpp"
#include "simulate/recorder.hpp"

namespace pendcore {

template <int width>
class RecordingLanes : public LaneRunner {
 protected:
  RecordingLanes(const Scene& scene, double t0, double t_end, const Options& options)
      : scene_(scene), t0_(t0), t_end_(t_end), options_(options) {
    for (LaneMember& member : members_) {
      member.recorded = Solution(options);
      member.recorded.t0 = t0_;
    }
  }

  virtual LaneSteps<width>& steps() = 0;
  virtual void put_state(int lane, const double* y) = 0;
  virtual void get_state(int lane, double* y) const = 0;
  virtual void get_state_before(int lane, double* y) const = 0;  ///< that before the last step
  /// Writes the dense output of the last step of a lane, in powers of theta, as a single run does;
  /// false if the single run may do it otherwise.
  virtual bool write_interpolant(int lane, double* coefficients) const = 0;
  /// What a lane evaluates: its member may have other parameters than the one that began last.
  virtual Stepper& stepper(int lane) const = 0;

  double direction() const { return t_end_ < t0_ ? -1.0 : 1.0; }
  /// The steps of a lane whose dense output a single run computes.
  long long interpolated(int lane) {
    return steps().interpolates_every_step ? steps().accepted[lane] : interpolated_[lane];
  }

  void choose_what_is_recorded(const LaneSource& source) {
    const bool watches = source.watches();
    LaneSteps<width>& at = steps();
    const int n = static_cast<int>(scene_.links.size());
    for (const Event& event : options_.events) {
      if (const auto difference = difference_of(event.function, n)) {
        differences_.push_back(*difference);
      }
    }
    const bool may_be_screened = differences_.size() == options_.events.size();
    at.every_step_is_recorded = watches || !may_be_screened;
    if (may_be_screened && !watches) at.differences = differences_;
    at.has_times = !options_.t_eval.empty();
    at.interpolates_every_step = source.watches_dense_output() || !options_.events.empty();
    at.needs_dense_output = at.interpolates_every_step || at.has_times;
    records_ = watches || at.needs_dense_output;
  }

  void start_recording(int lane, const Scene& scene, LaneSource& source) {
    LaneMember& member = members_[lane];
    interpolated_[lane] = 0;
    if (!records_) return;
    member.watch = source.watch(scene);
    Solution& recorded = member.recorded;
    recorded.t.clear();
    recorded.states.clear();
    recorded.found.clear();
    recorded.options.watch = member.watch.get();
    recorders_[lane] = std::make_unique<Recorder>(recorded, LaneStep(*this, lane), scene,
                                                  std::vector<long long>());
    recorders_[lane]->start(t0_, member.state);
    recorders_[lane]->state_settled(t0_, member.state.data());
    find_next_time(lane);
  }

  /// What comes of a step that was recorded.
  enum class AfterRecording : std::uint8_t { goes_on, ends, runs_alone };
  /// Records the last step of a lane, as a single run does.
  AfterRecording record_step(int lane) {
    LaneSteps<width>& at = steps();
    Recorder& recorder = *recorders_[lane];
    LaneStep step(*this, lane);
    const TwoDouble t_old{at.t_before[lane], at.t_low_before[lane]};
    const double h = at.h_before[lane];
    const double t_new = at.t[lane];
    const StepEnd end = recorder.step_accepted(step, t_old, h, t_new);
    if (step.runs_alone() || end.has_too_many_turns()) return AfterRecording::runs_alone;
    find_next_time(lane);
    if (!recorder.has_ended()) return AfterRecording::goes_on;
    if (end.is_within()) {
      const TwoDouble t = time_in_step(t_old, h, end.theta, t_new);
      if (t.high == t_old.high) return AfterRecording::runs_alone;
      std::vector<double>& y = members_[lane].state;
      std::vector<double> rows((step.interpolant_degree() + 1) * y.size());
      step.finite_interpolant(h, rows, y.size());
      step.state_within(rows.data(), end.theta, y.data());
      put_state(lane, y.data());
      at.t[lane] = t.high;
    }
    return AfterRecording::ends;
  }

  const Scene& scene_;
  double t0_, t_end_;
  const Options& options_;
  std::array<LaneMember, width> members_;

 private:
  /// The last step of a lane, for its recorder.
  class LaneStep final : public StepOutput {
   public:
    LaneStep(RecordingLanes& lanes, int lane) : lanes_(lanes), lane_(lane) {}
    int dimension() const override { return lanes_.stepper(lane_).dimension(); }
    int interpolant_degree() const override { return lanes_.stepper(lane_).interpolant_degree(); }
    void get_state(double* y) const override { lanes_.get_state_before(lane_, y); }
    void get_new_state(double* y) const override { lanes_.get_state(lane_, y); }
    void interpolant(double /*h*/, double* coefficients) override {
      if (!has_interpolant_) ++lanes_.interpolated_[lane_];
      has_interpolant_ = true;
      runs_alone_ |= !lanes_.write_interpolant(lane_, coefficients);
    }
    void sample(const double* coefficients, const TwoDouble& start, double h, const double* times,
                int count, double* states) const override {
      lanes_.stepper(lane_).sample(coefficients, start, h, times, count, states);
    }
    bool runs_alone() const { return runs_alone_; }

   private:
    RecordingLanes& lanes_;
    int lane_;
    bool has_interpolant_ = false;
    bool runs_alone_ = false;
  };

  /// Sets the time that is sampled next.
  void find_next_time(int lane) {
    const std::size_t next = members_[lane].recorded.t.size();
    const std::vector<double>& times = options_.t_eval;
    constexpr double far = std::numeric_limits<double>::infinity();
    steps().next_time[lane] = next < times.size() ? times[next] : direction() * far;
  }

  std::array<std::unique_ptr<Recorder>, width> recorders_;
  std::array<long long, width> interpolated_{};  ///< steps whose dense output was computed
  bool records_ = false;                         ///< whether members have recorders
  std::vector<Difference> differences_;
};

}  // namespace pendcore
