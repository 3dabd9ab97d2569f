/// \file
/// Finds events along a run: looks at each accepted step, and at each jump of the state.
///
/// Each event is a number at the ends of a step, computed from the states there, and a list of
/// zeros in between (integrate/root.hpp). What happened before a step matters nowhere: an event
/// whose function is zero where the step begins is not armed until it leaves zero, be it the start
/// of the run or an event at the end of the step before. So a run that goes on finds what one that
/// never stopped does.
#pragma once

#include <string>
#include <vector>

#include "pendcore/integrate/event.hpp"
#include "pendcore/integrate/stepper.hpp"
#include "pendcore/tip_line.hpp"

namespace pendcore {

class EventFinder {
 public:
  /// Adds to `found`, which may hold events already. Of event number k the first passed[k]
  /// occurrences end no run: one that ended there went on.
  EventFinder(const Scene& scene, const std::vector<Event>& events, std::vector<FoundEvent>& found,
              std::vector<long long> passed);

  /// Whether an event may end the run: a terminal one, or a function that may throw.
  bool may_end() const;

  /// Looks at an accepted step, with its dense output in `rows`. Returns the share of the step at
  /// which the run ends; 2 if it goes on.
  double look(const Stepper& stepper, const double* rows, const TwoDouble& t_old, double h,
              double t_new);

  /// The state jumped at the end of that step.
  void jump(double t, const double* before, const double* after);

  /// The event that ended the run; -1 if none did.
  int ended_by() const { return ended_by_; }

 private:
  struct Candidate {
    double theta;
    int direction;
    int event;
  };
  /// y[plus] - y[minus], the latter left out if negative: an angle or a rate.
  struct Difference {
    int plus;
    int minus;
    double of(const double* y) const { return minus < 0 ? y[plus] : y[plus] - y[minus]; }
  };
  struct Step {
    const Stepper& stepper;
    const double* rows;
    const TwoDouble& t_old;
    double h;
    double t_new;
  };

  Difference difference_of(const EventFunction& function) const;
  double function_at(std::size_t k, double t, const double* y);
  void find(std::size_t k, const Step& step);
  void find_difference(const Step& step, const Difference& difference, double value,
                       bool every_turn);
  void find_tip_line(std::size_t k, const Step& step);
  void find_function(std::size_t k, const events::Function& event, const Step& step);
  void node_values(std::size_t k, const Step& step, double& start, double& end);
  double sampled(std::size_t k, const Step& step, double theta);
  /// Calls visit(level) for each level between low and high that counts: the value itself, or every
  /// turn of it.
  template <class Visitor>
  void for_each_level(double value, bool every_turn, double low, double high, Visitor visit) const;
  void append(const Candidate& candidate, double t, const double* y);
  void cross(std::size_t k, double before, double after, double t, const double* y_before,
             const double* y_after);

  const std::vector<Event>& events_;
  std::vector<FoundEvent>& found_;
  std::vector<long long> passed_;
  std::vector<long long> counts_;
  std::vector<TipLine> tip_lines_;
  std::vector<int> tip_line_of_;  ///< of each event, its number among them, or -1
  int n_;
  int ended_by_ = -1;
  std::vector<Root> roots_;
  std::vector<TurningPoint> samples_;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> at_the_end_;  ///< those found at the end of the last step
  std::vector<double> polynomial_;
  std::vector<double> y_new_;
  std::vector<double> y_;
  // What was computed at the end of the last step, to be taken again at the start of the next.
  double node_t_ = 0.0;
  std::vector<double> node_y_;
  std::vector<double> node_values_;
};

}  // namespace pendcore
