#include "pendcore/integrate/integrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "pendcore/integrate/guards.hpp"

namespace pendcore {
namespace {

/// Looks at the clock seldom, yet often enough: the time limit is kept within a few milliseconds
/// and the monitor is called about every 50.
class Watch {
 public:
  Watch(const Limits& limits, double t0) : limits_(limits), t0_(t0) {}

  /// Status::finished means: go on.
  Status look(double t) {
    if (++steps_ < steps_between_looks_) return Status::finished;
    steps_ = 0;
    const Clock::time_point now = Clock::now();
    const double since_look = seconds(now - last_look_);
    last_look_ = now;
    if (since_look < 0.5e-3) {
      steps_between_looks_ = std::min(2 * steps_between_looks_, 1 << 20);
    } else if (since_look > 2e-3) {
      steps_between_looks_ = std::max(steps_between_looks_ / 2, 1);
    }
    if (seconds(now - start_) >= limits_.time_limit) return Status::time_limit;
    if (limits_.monitor && seconds(now - last_call_) >= 0.05) {
      last_call_ = now;
      if (!limits_.monitor((t - t0_) / (limits_.t_end - t0_))) return Status::interrupted;
    }
    return Status::finished;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  const Limits& limits_;
  double t0_;
  int steps_ = 0;
  int steps_between_looks_ = 16;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_look_ = start_;
  Clock::time_point last_call_ = start_;
};

/// The first component that is not finite, or -1.
int bad_component(const std::vector<double>& y) {
  const auto bad = std::ranges::find_if(y, [](double x) { return !std::isfinite(x); });
  return bad == y.end() ? -1 : static_cast<int>(bad - y.begin());
}

/// Of the attempted step: the component whose new value, or new rate, is not finite, or -1.
int bad_component_of_trial(Stepper& stepper, double t_new) {
  std::vector<double> y(stepper.dimension());
  std::vector<double> dydt(stepper.dimension());
  stepper.get_new_state(y.data());
  stepper.evaluate(t_new, y.data(), dydt.data());
  return std::max(bad_component(y), bad_component(dydt));
}

/// Hairer's test, every thousandth accepted step and after each suspicious one: fifteen hits,
/// not interrupted by six misses, and the problem is called stiff (Hairer and Wanner, IV.2).
void test_stiffness(const Stepper& stepper, double h, Position& position) {
  const double boundary = stepper.info().stability;
  if (boundary == 0.0) return;
  if (position.statistics.accepted % 1000 != 0 && position.stiff_hits == 0) return;
  if (stepper.stiffness(h) > boundary) {
    position.stiff_misses = 0;
    if (++position.stiff_hits == 15) position.statistics.stiff = true;
  } else if (++position.stiff_misses == 6) {
    position.stiff_hits = 0;
  }
}

void count_accepted(Statistics& statistics, double h, bool cut, bool at_max_step) {
  ++statistics.accepted;
  ++(cut           ? statistics.limited_by_break
     : at_max_step ? statistics.limited_by_max_step
                   : statistics.limited_by_tolerance);
  const long long uncut = statistics.accepted - statistics.limited_by_break;
  if (cut && uncut > 0) return;
  const double size = std::abs(h);
  const bool first = uncut <= 1;
  statistics.min_step = first ? size : std::min(statistics.min_step, size);
  statistics.max_step = first ? size : std::max(statistics.max_step, size);
}

}  // namespace

Ending integrate(Stepper& stepper, Position& position, Position& resumable, const Limits& limits,
                 Observer& observer, Breaks* breaks) {
  const long long evaluations_before = stepper.evaluations - position.statistics.nfev;
  auto write_down = [&](Position& target) {
    target = position;
    target.statistics.nfev = stepper.evaluations - evaluations_before;
    stepper.get_state(target.y.data());
    stepper.get_derivative(target.dydt.data());
    if (breaks != nullptr) target.modes = breaks->modes();
  };
  bool cut_before = false;  // a step was cut to end at t_end: later ones depend on t_end
  auto end_with = [&](Status status, int bad = -1) {
    write_down(position);
    if (!cut_before) resumable = position;
    return Ending{status, cut_before, bad, nullptr};
  };
  std::optional<Guards> guards;
  if (breaks != nullptr) guards.emplace(stepper, *breaks);
  std::vector<double> state(stepper.dimension());
  std::vector<double> rate(stepper.dimension());
  int crossings_at_once = 0;
  /// The law changes at the state that the stepper stands at.
  auto change_law = [&](int guard) {
    const double t = position.t.high;
    stepper.get_state(state.data());
    const Status status = breaks->cross(guard, t, state.data());
    if (status != Status::finished) return status;
    stepper.evaluate(t, state.data(), rate.data());
    stepper.start(state.data(), rate.data());
    position.control = StepControl{};
    return status;
  };

  const MethodInfo& method = stepper.info();
  Watch watch(limits, position.t.high);
  int bad = -1;  // component of the last trial, while trials are not finite
  bool trial_was_finite = true;
  long long attempts = 0;
  const double rounding = std::numeric_limits<double>::epsilon();

  if (bad_component(position.dydt) >= 0) {
    return end_with(Status::non_finite, bad_component(position.dydt));
  }
  try {
    while (true) {
      const double t = position.t.high;
      double left = difference(limits.t_end, position.t);
      if (left == 0.0) return end_with(Status::finished);
      if (attempts == limits.max_steps) return end_with(Status::max_steps);
      const Status clock = watch.look(t);
      if (clock != Status::finished) return end_with(clock);

      // The last step may be a hundredth longer (Hairer's rule), but not longer than max_step, the
      // last bits of t aside: a step of those alone would not be one.
      double h = position.h;
      const double last_bits = 4.0 * rounding * std::max(std::abs(t), std::abs(limits.t_end));
      const double reach =
          std::min(1.01 * std::abs(h), std::max(std::abs(h), limits.max_step)) + last_bits;
      double target = limits.t_end;
      bool at_break = false;  // the target is a time of the law's, not the end
      if (breaks != nullptr) {
        const double next = breaks->next_time(t);
        at_break = (limits.t_end - next) * left > 0.0;
        if (at_break) {
          target = next;
          left = difference(next, position.t);
        }
      }
      const bool cut = std::abs(left) <= reach;
      if (cut && at_break) {
        h = left;
      } else if (cut) {
        if (!cut_before) {
          write_down(resumable);
          observer.end_in_sight();
        }
        cut_before = true;
        h = left;
      } else if (std::abs(h) <= 10.0 * rounding * std::abs(t) || std::abs(h) < 1e-300) {
        return end_with(trial_was_finite ? Status::step_too_small : Status::non_finite, bad);
      }

      ++attempts;
      Attempt attempt = stepper.attempt(t, h, position.control.gain(method));
      if (!std::isfinite(attempt.squared_error)) {
        // Beyond the square root of the largest double the norm overflows, and nothing is wrong.
        bad = bad_component_of_trial(stepper, t + h);
        trial_was_finite = bad < 0 && !std::isnan(attempt.squared_error);
      } else {
        trial_was_finite = true;
        bad = -1;
      }
      if (trial_was_finite && (attempt.squared_error <= 1.0 || limits.fixed_step)) {
        Crossing crossing;
        const double whole = h;
        if (guards) {
          crossing = guards->first(position.t, h);
          const bool is_now = crossing.theta * std::abs(h) <= 2.0 * rounding * std::abs(t);
          if (crossing.guard >= 0 && is_now) {
            // The law changes where the step begins.
            if (++crossings_at_once > 4 * breaks->guards()) return end_with(Status::step_too_small);
            const Status status = change_law(crossing.guard);
            if (status != Status::finished) return end_with(status);
            continue;
          }
          crossings_at_once = 0;
          if (crossing.guard >= 0) {
            // Redone to the located time: the state comes from the method, not the interpolant.
            h = crossing.theta * whole;
            for (int polish = 0; polish < 6; ++polish) {
              attempt = stepper.attempt(t, h, position.control.gain(method));
              const double miss = guards->miss(crossing.guard, position.t, h);
              if (!(std::abs(miss) <= 0.5)) break;
              const double better = h - miss * h;
              if (better == h || std::abs(miss * h) <= rounding * std::abs(t)) break;
              h = better;
            }
            // What the whole step strode over, the shorter one may see: friction's peak at rest.
            if (!(attempt.squared_error <= 1.0) && !limits.fixed_step) {
              ++position.statistics.rejected;
              position.h = h * position.control.reject(method, attempt);
              position.h_is_max_step = false;
              continue;
            }
          }
        }
        const bool breaks_here = crossing.guard >= 0 || (cut && at_break);
        const TwoDouble t_new = cut && crossing.guard < 0 ? TwoDouble{target, 0.0} : position.t + h;
        count_accepted(position.statistics, h, cut || breaks_here, position.h_is_max_step);
        test_stiffness(stepper, h, position);
        if (crossing.guard >= 0 || (breaks != nullptr && breaks->settles_every_step())) {
          stepper.get_new_state(state.data());
          if (breaks->settle(crossing.guard, t_new.high, state.data())) {
            stepper.set_new_state(state.data());
          }
        }
        observer.step_accepted(stepper, position.t, h, t_new.high);
        stepper.accept(t_new.high);
        position.t = t_new;
        if (breaks_here) {
          const Status status = change_law(crossing.guard);
          if (status != Status::finished) return end_with(status);
          position.h = std::copysign(std::max(std::abs(position.h), std::abs(whole)), whole);
        } else if (!limits.fixed_step) {
          position.h = h * position.control.accept(method, attempt);
          position.h_is_max_step = std::abs(position.h) >= limits.max_step;
          if (position.h_is_max_step) position.h = std::copysign(limits.max_step, h);
        }
      } else {
        ++position.statistics.rejected;
        if (limits.fixed_step) return end_with(Status::non_finite, bad);
        position.h = h * position.control.reject(method, attempt);
        position.h_is_max_step = false;
      }
    }
  } catch (...) {  // what a function of the user's throws
    Ending ending = end_with(Status::callback_error);
    ending.error = std::current_exception();
    return ending;
  }
}

}  // namespace pendcore
