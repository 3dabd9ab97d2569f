#include "pendcore/integrate/integrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

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

bool all_finite(const std::vector<double>& y) {
  return std::ranges::all_of(y, [](double x) { return std::isfinite(x); });
}

/// "q_2" for component 1 of a chain of two links, "qd_1" for component 2.
std::string component_name(std::size_t i, std::size_t dimension) {
  const std::size_t n = dimension / 2;
  return i < n ? "q_" + std::to_string(i + 1) : "qd_" + std::to_string(i - n + 1);
}

Ending ending(Status status, double t, const std::string& where = "") {
  std::string message(text(status).sentence);
  if (!text(status).success) {
    char time[40];
    std::snprintf(time, sizeof time, "t = %.17g s", t);
    message += std::string(" (at ") + time + where + ")";
  }
  return {status, message};
}

Ending not_finite(const std::vector<double>& y, double t) {
  std::size_t i = 0;
  while (i < y.size() && std::isfinite(y[i])) ++i;
  return ending(Status::non_finite, t, i < y.size() ? ", " + component_name(i, y.size()) : "");
}

std::vector<double> new_state(const Stepper& stepper) {
  std::vector<double> y(stepper.dimension());
  stepper.get_new_state(y.data());
  return y;
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
                 Observer& observer) {
  const long long evaluations_before = stepper.evaluations - position.statistics.nfev;
  auto write_down = [&](Position& target) {
    target = position;
    target.statistics.nfev = stepper.evaluations - evaluations_before;
    stepper.get_state(target.y.data());
    stepper.get_derivative(target.dydt.data());
  };
  auto end_with = [&](Ending result, bool was_cut) {
    write_down(position);
    if (!was_cut) resumable = position;
    return result;
  };

  const MethodInfo& method = stepper.info();
  Watch watch(limits, position.t.high);
  bool cut_before = false;  // a step was cut to end at t_end: later ones depend on t_end
  bool trial_was_finite = true;
  long long attempts = 0;
  const double rounding = std::numeric_limits<double>::epsilon();

  if (!all_finite(position.dydt))
    return end_with(not_finite(position.dydt, position.t.high), false);

  while (true) {
    const double t = position.t.high;
    const double left = difference(limits.t_end, position.t);
    if (left == 0.0) return end_with(ending(Status::finished, t), cut_before);
    if (attempts == limits.max_steps) return end_with(ending(Status::max_steps, t), cut_before);
    const Status clock = watch.look(t);
    if (clock != Status::finished) return end_with(ending(clock, t), cut_before);

    double h = position.h;
    const double reach = std::min(1.01 * std::abs(h), std::max(std::abs(h), limits.max_step));
    const bool cut = std::abs(left) <= reach;
    if (cut) {
      if (!cut_before) {
        write_down(resumable);
        observer.end_in_sight();
      }
      cut_before = true;
      h = left;
    } else if (std::abs(h) <= 10.0 * rounding * std::abs(t) || std::abs(h) < 1e-300) {
      if (trial_was_finite) return end_with(ending(Status::step_too_small, t), cut_before);
      return end_with(not_finite(new_state(stepper), t), cut_before);
    }

    ++attempts;
    const Attempt attempt = stepper.attempt(t, h, position.control.gain(method));
    const bool finite = !std::isnan(attempt.squared_error);
    if (attempt.squared_error <= 1.0 || (limits.fixed_step && finite)) {
      trial_was_finite = true;
      const TwoDouble t_new = cut ? TwoDouble{limits.t_end, 0.0} : position.t + h;
      count_accepted(position.statistics, h, cut, position.h_is_max_step);
      test_stiffness(stepper, h, position);
      observer.step_accepted(stepper, t, h, t_new.high);
      stepper.accept(t_new.high);
      position.t = t_new;
      if (!limits.fixed_step) {
        position.h = h * position.control.accept(method, attempt);
        position.h_is_max_step = std::abs(position.h) >= limits.max_step;
        if (position.h_is_max_step) position.h = std::copysign(limits.max_step, h);
      }
    } else {
      trial_was_finite = finite;
      ++position.statistics.rejected;
      if (limits.fixed_step) {
        return end_with(not_finite(new_state(stepper), t), cut_before);
      }
      position.h = h * position.control.reject(method, attempt);
      position.h_is_max_step = false;
    }
  }
}

}  // namespace pendcore
