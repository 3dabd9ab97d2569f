/// \file
/// Finds events along a run: looks at each accepted step, and at each jump of the state.
///
/// Each event is a number at the ends of a step, computed from the states there, and a list of
/// zeros in between (integrate/events/root.hpp). An event whose function is zero where a step
/// begins is not armed until the function leaves zero, at the start of the run as after an event at
/// the end of the step before.
///
/// A run may start where an event ended another one, on a zero to rounding only. There, an event is
/// not armed until its function has left zero by more than rounding (event_start.cpp). After that,
/// what happened before a step never matters, so that a resumed run finds the same events as a run
/// that never stopped.
#pragma once

#include <string>
#include <vector>

#include "integrate/loop/integrate.hpp"
#include "pendcore/events.hpp"
#include "simulate/tip_line.hpp"

namespace pendcore {

class EventFinder {
 public:
  /// Adds events to `found`, which may have some already. The first passed[k] occurrences of event
  /// number k do not end the run: a run that ended there was continued. The run starts at t0.
  EventFinder(const Scene& scene, const std::vector<Event>& events, std::vector<FoundEvent>& found,
              std::vector<long long> passed, double t0);

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

  /// An angle or a rate: y[plus] - y[minus], or y[plus] alone if `minus` is negative. The event is
  /// where it is `value`, or where it is `value` plus any number of turns.
  struct Difference {
    int plus;
    int minus;
    double value = 0.0;
    bool every_turn = false;
    double of(const double* y) const { return minus < 0 ? y[plus] : y[plus] - y[minus]; }
    /// The difference minus a level; 0 within the rounding of the state.
    double from(double level, const double* y) const;
  };
  /// The differences of all events; empty if one of them is of another kind.
  std::vector<Difference> differences() const;

 private:
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
  };
  /// value + (first + i) 2 pi for i = 0 ... count - 1
  struct Levels {
    double value, first, count;
    double at(int i) const;
  };

  Difference difference_of(const EventFunction& function) const;
  double function_at(std::size_t k, double t, const double* y);
  void find(std::size_t k, const Step& step);
  double rounding_at_start(const Difference& difference, const Step& step) const;
  double rounding_at_start(std::size_t k, const Step& step, double start);
  double armed_value(std::size_t k, double value) const;
  void find_difference(std::size_t k, const Step& step);
  int count_turns(std::size_t k, const Levels& levels);
  void find_tip_line(std::size_t k, const Step& step);
  void find_function(std::size_t k, const events::Function& event, const Step& step);
  void node_values(std::size_t k, const Step& step, double& start, double& end);
  double sampled(std::size_t k, const Step& step, double theta);
  static Levels levels_between(const Difference& difference, double low, double high);
  Levels levels_along(const Difference& difference, int degree, double end, double noise);
  void append(const Candidate& candidate, double t, const double* y);
  void cross(std::size_t k, double before, double after, double t, const double* y_before,
             const double* y_after);

  const std::vector<Event>& events_;
  std::vector<FoundEvent>& found_;
  std::vector<long long> passed_;
  std::vector<long long> counts_;
  std::vector<TipLine> tip_lines_;
  std::vector<int> tip_line_of_;  ///< the number of each event's tip line, or -1
  int n_;
  int ended_by_ = -1;
  double turns_ = 0.0;    ///< turns that steps went through, not counting one a step
  int too_many_of_ = -1;  ///< the event with too many turns, if there is one
  std::vector<Root> roots_;
  std::vector<TurningPoint> samples_;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> at_the_end_;  ///< the events found at the end of the last step
  std::vector<double> polynomial_;
  std::vector<double> bernstein_;
  std::vector<double> y_new_;
  std::vector<double> y_;
  /// How close to zero an event's function may come by rounding before the event is armed; 0 from
  /// then on.
  std::vector<double> unarmed_within_;
  double t0_;
  // Values at the end of the last step, which are used again at the start of the next.
  double node_t_;
  std::vector<double> node_y_;
  std::vector<double> node_values_;
};

}  // namespace pendcore
