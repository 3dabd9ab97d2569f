/// \file
/// Fills lanes with members and takes their steps, whatever the method.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "ensemble/lane_equations.hpp"
#include "ensemble/lane_recording.hpp"
#include "integrate/method_list.hpp"
#include "pendcore/methods.hpp"
#include "pendcore/simulate.hpp"
#include "pendcore/solution.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/method_choice.hpp"
#include "simulate/steppers.hpp"

namespace pendcore {

/// With this many members left, or fewer, running them one by one is faster.
template <int width>
constexpr int few_lanes = width / 2;
/// Steps between two looks at whether to go on: a fraction of a millisecond.
inline constexpr int rounds_at_once = 256;

/// Lanes run members of this scene. A member may have other parameters; the equations are those of
/// the scene itself.
struct LaneTask {
  const Scene& scene;
  std::shared_ptr<const EquationsOfMotion> equations;
  double t0, t_end;
  const Options& options;
};

/// The part of a runner that does not depend on the method.
template <int width>
class LaneLoop : public RecordingLanes<width> {
  using Base = RecordingLanes<width>;
  using Base::members_;
  using Base::scene_;
  using Base::statistics_;
  using Base::t0_;

 public:
  LaneLoop(const LaneTask& task, std::string_view method)
      : RecordingLanes<width>(task.scene, task.t0, task.t_end, task.options),
        interval_{t_end_, options_.max_step, options_.max_steps},
        rtol_(relative_tolerances(options_, scene_.links.size())),
        atol_(absolute_tolerances(options_, scene_.links.size())),
        rate_(2 * scene_.links.size()),
        equations_(task.equations),
        method_(method),
        kinds_(kinds_of(*task.equations)) {}

  void run(LaneSource& source) override {
    this->choose_what_is_recorded(source);
    bool goes_on = true;
    for (int lane = 0; lane < width; ++lane) fill(lane, source);
    while (steps().active != 0 && goes_on) {
      if (is_exhausted_ && std::popcount(steps().active) <= few_lanes<width>) {
        for (int lane = 0; lane < width; ++lane) {
          if ((steps().active & (1U << lane)) != 0) finish_alone(lane, source);
        }
        return;
      }
      Attention attention = take_steps();
      for (int lane = 0; lane < width; ++lane) {
        const LaneBits bit = 1U << lane;
        if ((attention.looks & bit) != 0 && looks_stiff(lane)) attention.runs_alone |= bit;
        const bool is_recorded =
            (attention.recorded & bit) != 0 && (attention.runs_alone & bit) == 0;
        const AfterRecording after =
            is_recorded ? this->record_step(lane) : AfterRecording::goes_on;
        if ((attention.runs_alone & bit) != 0 || after == AfterRecording::runs_alone) {
          source.run_alone(members_[lane].number);
        } else if (after == AfterRecording::ends) {
          end(lane, source, Status::event);
        } else if ((attention.ended & bit) != 0) {
          end(lane, source, Status::finished);
        } else if ((attention.used_up & bit) != 0) {
          end(lane, source, Status::max_steps);
        } else {
          continue;
        }
        fill(lane, source);
      }
      goes_on = source.goes_on();
    }
  }

 protected:
  using AfterRecording = typename Base::AfterRecording;
  using Base::get_state;
  using Base::options_;
  using Base::steps;
  using Base::t_end_;
  /// The derivative at the state of a lane, and what the method keeps between steps.
  virtual void get_derivative(int lane, double* dydt) = 0;
  virtual std::vector<double> saved_state(int lane) = 0;
  virtual Attention take_steps() = 0;
  /// Puts equations_, those of a scene, into a lane.
  virtual void put_equations(int lane, const Scene& scene) = 0;
  /// Puts a start, at which the rates are rate_, into a lane.
  virtual void put_start(int lane, const std::vector<double>& y) = 0;
  virtual long long evaluations_of(int lane) = 0;
  /// Whether the last step of a lane suggests that the member is stiff.
  virtual bool looks_stiff(int /*lane*/) { return false; }

  /// Prepares equations in lanes. Lanes without a member have the constants of the scene itself, so
  /// that their steps do no harm.
  template <class InLanes>
  void prepare(InLanes& in_lanes) const {
    in_lanes.prepare(scene_, *equations_);
    for (int lane = 0; lane < width; ++lane) in_lanes.put(lane, scene_, *equations_);
  }
  Stepper& stepper(int lane) const override { return *steppers_[lane]; }

  LaneInterval interval_;
  std::vector<double> rtol_, atol_;
  std::vector<double> rate_;                            ///< at the start of the member that begins
  std::shared_ptr<const EquationsOfMotion> equations_;  ///< those of that member

 private:
  /// Begins the next member in a lane, if there is one.
  void fill(int lane, LaneSource& source) {
    LaneMember& member = members_[lane];
    steps().active &= ~(1U << lane);
    while (const Scene* scene = source.next(member)) {
      if (begin(lane, *scene, source)) {
        steps().active |= 1U << lane;
        return;
      }
      source.run_alone(member.number);
    }
    is_exhausted_ = true;
  }

  /// Goes on with the member of a lane as a single run, from where the lane stands.
  void finish_alone(int lane, LaneSource& source) {
    LaneMember& member = members_[lane];
    if (steps().accepted[lane] + steps().rejected[lane] == 0) {
      source.run_alone(member.number);
      return;
    }
    const Scene& scene = source.scene_of(member.number);
    const Solution begun = stopped_run(lane);
    const long long left =
        options_.max_steps - begun.statistics.accepted - begun.statistics.rejected;
    const Solution whole = resume(scene, begun, t_end_, {}, left, std::nullopt,
                                  [&source](double) { return source.goes_on(); });
    if (whole.status == Status::interrupted) return;
    member.state = whole.y_reached;
    member.t = whole.t_reached;
    member.status = whole.status;
    member.recorded.states = whole.states;
    member.recorded.found = whole.found;
    add(statistics_, whole.statistics);
    source.ended(member);
  }

  /// What the member of a lane did so far.
  Statistics statistics_of(int lane) {
    return {.nfev = evaluations_of(lane),
            .accepted = steps().accepted[lane],
            .rejected = steps().rejected[lane]};
  }

  /// The run of a lane so far, as if a limit had stopped it.
  Solution stopped_run(int lane) {
    const LaneSteps<width>& at = steps();
    const std::size_t size = 2 * scene_.links.size();
    Solution run = members_[lane].recorded;
    run.options.method = find_method(chosen_method(scene_, options_)).name;
    run.t0 = t0_;
    run.t_end = t_end_;
    run.n = static_cast<int>(scene_.links.size());
    run.dimension = static_cast<int>(size);
    run.start.resize(size);
    run.resumable_kept = {.t = run.t.size(), .steps = 0, .found = run.found.size()};
    IntegratorState state;
    state.t = {at.t[lane], at.t_low[lane]};
    state.h = at.h[lane];
    state.h_is_max_step = std::abs(state.h) >= options_.max_step;
    state.control = {at.log2_error_before[lane], at.after_rejection[lane] != 0};
    state.statistics = statistics_of(lane);
    state.y.resize(size);
    state.dydt.resize(size);
    get_state(lane, state.y.data());
    get_derivative(lane, state.dydt.data());
    state.stepper.memory = saved_state(lane);
    run.dense.degree = stepper_->interpolant_degree();
    run.statistics = state.statistics;
    run.t_reached = state.t.high;
    run.y_reached = state.y;
    run.resumable = std::make_shared<const IntegratorState>(std::move(state));
    return run;
  }

  /// Returns false if the beginning is not that of a usual run.
  bool begin(int lane, const Scene& scene, LaneSource& source) {
    const std::vector<double>& y = members_[lane].state;
    const bool is_varied = &scene != &scene_;
    if (is_varied && !is_allowed(scene)) return false;
    if (!stepper_ || is_varied) {
      if (is_varied)
        equations_ = std::make_shared<const EquationsOfMotion>(equations_of_motion(scene));
      stepper_ = make_stepper(scene, *equations_, method_, false, false);
      stepper_->set_tolerances(rtol_.data(), atol_.data());
    }
    if (is_varied && kinds_of(*equations_) != kinds_) return false;
    if (steppers_[lane] != stepper_) put_equations(lane, scene);
    steppers_[lane] = stepper_;
    stepper_->evaluate(t0_, y.data(), rate_.data());
    if (bad_component(y) >= 0 || bad_component(rate_) >= 0) return false;
    LaneSteps<width>& at = steps();
    at.t[lane] = t0_;
    at.t_low[lane] = 0.0;
    at.log2_error_before[lane] = StepControl::log2_smallest_error;
    at.after_rejection[lane] = 0;
    at.accepted[lane] = at.rejected[lane] = 0;
    at.steps_to_look[lane] = first_stiffness_look;
    put_start(lane, y);
    this->start_recording(lane, scene, source);
    return true;
  }

  static bool is_allowed(const Scene& scene) {
    try {
      check(scene);
    } catch (const std::invalid_argument&) {
      return false;
    }
    return true;
  }

  void end(int lane, LaneSource& source, Status status) {
    LaneMember& member = members_[lane];
    get_state(lane, member.state.data());
    member.t = steps().t[lane];
    member.status = status;
    add(statistics_, statistics_of(lane));
    source.ended(member);
  }

  std::string_view method_;
  std::vector<int> kinds_;            ///< what all members have in common
  std::shared_ptr<Stepper> stepper_;  ///< of the members that begin
  std::array<std::shared_ptr<Stepper>, width> steppers_;
  bool is_exhausted_ = false;  ///< no member is left to begin
};

/// The runners of the methods of Dormand and Prince, and of Taylor series; null if the scene has
/// none in lanes. The former are compiled in lanes_of_four.cpp and lanes_of_eight.cpp.
template <InstructionSet set>
std::unique_ptr<LaneRunner> make_runge_kutta_lanes(std::string_view method, const LaneTask& task);
template <InstructionSet set>
std::unique_ptr<LaneRunner> make_series_lanes(const LaneTask& task);

}  // namespace pendcore
