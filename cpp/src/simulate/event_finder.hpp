/// \file
/// Finds events along a run: looks at each accepted step, and at each jump of the state.
///
/// Each event is a number at the ends of a step, computed from the states there, and a list of
/// zeros in between (integrate/events/root.hpp). An event whose function is zero where a step
/// begins is not armed until the function leaves zero, at the start of the run as after an event at
/// the end of the step before.
///
/// A run may start where an event ended another one, on a zero to rounding only. There, an event is
/// not armed until its function has left zero by more than rounding: the state that a run stored at
/// an event is the dense output at the event's time, so it is off the event by the rounding of the
/// state, of the polynomial and of time, each relative to the sizes of what is added up. After
/// that, what happened before a step never matters, so that a resumed run finds the same events as
/// a run that never stopped.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "integrate/loop/integrate.hpp"
#include "pendcore/events.hpp"
#include "simulate/event_levels.hpp"
#include "simulate/tip_line.hpp"

namespace pendcore {

class EventFinder {
 public:
  /// Adds events to `found`, which may have some already. The first passed[k] occurrences of event
  /// number k do not end the run: a run that ended there was continued. The run starts at t0.
  EventFinder(const Scene& scene, const std::vector<Event>& events, std::vector<FoundEvent>& found,
              const std::vector<long long>& passed, double t0);

  /// Whether an event may end the run: a terminal one, a function that may throw, too many turns.
  bool may_end() const;

  /// Looks at an accepted step, with its dense output in `rows`. Returns where in the step a
  /// terminal event ends the run, if one does.
  StepEnd look(const StepOutput& output, const double* rows, const TwoDouble& t_old, double h,
               double t_new);

  /// The state jumped at the end of that step.
  void jump(double t, const double* before, const double* after);

  /// The event that ended the run; -1 if none did.
  int ended_by() const { return ended_by_; }

 private:
  struct Watched {
    const Event& event;
    int number;
    std::optional<Difference> difference = {};
    std::optional<TipLine> tip_line = {};
    long long passed = 0;
    long long count = 0;
    /// How close to zero the function may come by rounding before the event is armed; 0 from then
    /// on.
    double unarmed_within = 0.0;
    double node_value = 0.0;  ///< at the end of the last step, used again at the start of the next

    /// The value with which a step begins or a jump is entered: 0 if the event is not armed there.
    double armed(double value) const { return is_within_rounding(value) ? 0.0 : value; }
    bool is_within_rounding(double value) const { return std::abs(value) <= unarmed_within; }
  };
  struct Candidate {
    double theta;
    int direction;
    int event;
  };
  struct Step {
    const StepOutput& output;
    const double* rows;
    const TwoDouble& t_old;
    double h;
    double t_new;

    const double* row(int power) const {
      return rows + static_cast<std::ptrdiff_t>(power) * output.dimension();
    }
  };

  double value(Watched& watched, double t, const double* y);
  void find(Watched& watched, const Step& step);
  double natural_rate(const Step& step) const;
  double rounding_at_start(const Watched& watched, const Step& step, double start);
  void find_difference(Watched& watched, const Difference& difference, const Step& step);
  int count_turns(const Watched& watched, const Levels& levels);
  void find_value(Watched& watched, const Step& step);
  void find_between_samples(Watched& watched, const Step& step, double start, double end);
  void append(const Candidate& candidate, double t, const double* y);

  std::vector<Watched> watched_;
  std::vector<FoundEvent>& found_;
  int n_;
  int ended_by_ = -1;
  double turns_ = 0.0;    ///< turns that steps went through, not counting one a step
  int too_many_of_ = -1;  ///< the event with too many turns, if there is one
  std::vector<Root> roots_;
  std::vector<TurningPoint> samples_;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> at_the_end_;  ///< the events found at the end of the last step
  std::vector<double> polynomial_;
  std::vector<double> y_new_;
  std::vector<double> y_;
  double t0_;
  double node_t_;  ///< the end of the last step, and the state there
  std::vector<double> node_y_;
};

}  // namespace pendcore
