#include "simulate/event_finder.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "arithmetic/epsilon.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

constexpr double most_turns = 1e6;  // these take seconds, and fit into a list
/// The rounding at the start of a run, as a share of the sizes of what is added up.
constexpr double share_at_start = 8.0 * last_bits_share;

}  // namespace

EventFinder::EventFinder(const Scene& scene, const std::vector<Event>& events,
                         std::vector<FoundEvent>& found, const std::vector<long long>& passed,
                         double t0)
    : found_(found),
      n_(static_cast<int>(scene.links.size())),
      t0_(t0),
      node_t_(t0),
      node_y_(2 * scene.links.size(), std::nan("")) {
  watched_.reserve(events.size());
  for (std::size_t k = 0; k < events.size(); ++k) {
    watched_.push_back({.event = events[k],
                        .number = static_cast<int>(k),
                        .difference = difference_of(events[k].function, n_)});
    Watched& one = watched_.back();
    if (k < passed.size()) one.passed = passed[k];
    if (const auto* line = std::get_if<events::TipLine>(&events[k].function)) {
      one.tip_line.emplace(scene, *line);
    }
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    ++watched_[found[i].event].count;
    // A continued run may begin between two changes at one time.
    if (found[i].t == found.back().t) at_the_end_.push_back(i);
  }
}

bool EventFinder::may_end() const {
  return std::ranges::any_of(watched_, [](const Watched& one) {
    if (one.event.terminal > 0) return true;
    if (one.difference) return one.difference->every_turn;
    return !one.tip_line;
  });
}

/// The number of levels, or none once there were too many in this run. Turns beyond one a step are
/// counted, because max_steps does not bound them.
int EventFinder::count_turns(const Watched& watched, const Levels& levels) {
  if (!(levels.count <= 1.0)) turns_ += levels.count - 1.0;
  if (turns_ <= most_turns) return static_cast<int>(levels.count);
  too_many_of_ = watched.number;
  return 0;
}

/// The rates of all links and those that the accelerations give them within a radian, rad/s. The
/// first step of a run may be much shorter than the step on which its start lay as an event, so it
/// does not tell the sizes of the numbers there.
double EventFinder::natural_rate(const Step& step) const {
  double rate = 0.0;
  double acceleration = 0.0;
  for (int i = n_; i < 2 * n_; ++i) {
    rate = std::max(rate, std::abs(step.rows[i]));
    acceleration = std::max(acceleration, std::abs(step.row(1)[i] / step.h));
  }
  return rate + std::sqrt(acceleration);
}

void EventFinder::find_difference(Watched& watched, const Difference& difference,
                                  const Step& step) {
  const int degree = step.output.interpolant_degree();
  polynomial_.resize(degree + 1);
  double size = 0.0;
  double moved = 0.0;
  double moved_with_its_links = 0.0;
  for (int p = 0; p <= degree; ++p) {
    polynomial_[p] = difference.of(step.row(p));
    const double size_of_row = difference.size(step.row(p));
    size += size_of_row;
    if (p == 0) continue;
    moved += std::abs(polynomial_[p]);
    moved_with_its_links = std::max(moved_with_its_links, size_of_row);
  }
  if (step.t_old.high == t0_) {
    const double natural_size =
        difference.plus < n_ ? 1.0 + std::abs(difference.value) : natural_rate(step);
    watched.unarmed_within = share_at_start * (natural_size + size);
  }
  // A held joint passes no level, whatever the last bits of its links' angles do.
  if (moved <= 64.0 * epsilon * moved_with_its_links) return;
  const double end = difference.of(y_new_.data());
  const Levels levels = levels_along(difference, polynomial_, end, 8.0 * epsilon * size);
  const int count = count_turns(watched, levels);
  bool is_armed = true;
  for (int i = 0; i < count; ++i) {
    const double level = levels.at(i);
    const double there = difference.from(level, y_new_.data());
    polynomial_[0] = watched.armed(difference.from(level, step.rows));
    const double within = polynomial_[0] == 0.0 ? watched.unarmed_within : 0.0;
    const double noise = std::max(8.0 * epsilon * (size + std::abs(level)), within);
    const bool has_left = find_roots(polynomial_.data(), degree, there, noise, roots_);
    is_armed &= has_left || std::abs(there) > within;
  }
  if (is_armed) watched.unarmed_within = 0.0;
}

/// Finds the zeros of a TipLine or a Function. It costs more than a difference, so the value at the
/// start of a step is known from the step before.
void EventFinder::find_value(Watched& watched, const Step& step) {
  const double t = step.t_old.high;
  const bool is_known = node_t_ == t && std::equal(node_y_.begin(), node_y_.end(), step.rows);
  double start = is_known ? watched.node_value : value(watched, t, step.rows);
  if (t == t0_) watched.unarmed_within = rounding_at_start(watched, step, start);
  if (!watched.is_within_rounding(start)) watched.unarmed_within = 0.0;
  const double end = watched.node_value = value(watched, step.t_new, y_new_.data());
  start = watched.armed(start);
  // After the start, the value of a Function tells nothing of rounding: the function may jump.
  bool is_armed = true;
  if (watched.tip_line) {
    const bool has_left =
        watched.tip_line->find(step.rows, step.output.interpolant_degree(), step.output.dimension(),
                               t, step.h, start, end, watched.unarmed_within, roots_);
    is_armed = has_left || !watched.is_within_rounding(end);
  } else {
    find_between_samples(watched, step, start, end);
  }
  if (is_armed) watched.unarmed_within = 0.0;
}

/// Finds the zeros of a Function between its values at the ends of a step.
void EventFinder::find_between_samples(Watched& watched, const Step& step, double start,
                                       double end) {
  const auto& function = std::get<events::Function>(watched.event.function);
  const auto sampled = [&](double theta) {
    step.output.state_within(step.rows, theta, y_.data());
    return value(watched, fma(theta, step.h, step.t_old.high), y_.data());
  };
  const double spaced = std::ceil(std::abs(step.h) / function.max_step);
  const int samples = static_cast<int>(std::clamp(spaced, double(function.samples), 1e6));
  samples_.clear();
  for (int i = 1; i < samples; ++i) {
    const double theta = static_cast<double>(i) / samples;
    samples_.push_back({theta, sampled(theta)});
  }
  find_roots(sampled, start, samples_, end, 0.0, roots_);
}

/// What rounding may do, at the start of a run, to a TipLine or a Function with the value `start`.
/// A Function is asked how much it changes as each of its arguments goes on by its rounding; it may
/// be undefined there. A run of a few units in the last place of its time has events of time in
/// each of them.
double EventFinder::rounding_at_start(const Watched& watched, const Step& step, double start) {
  double t = step.t_old.high;
  if (watched.tip_line) return 8.0 * watched.tip_line->rounding(t, step.rows);
  const auto n = static_cast<std::size_t>(n_);
  const double rate = natural_rate(step);
  std::copy_n(step.rows, 2 * n, y_.begin());
  double sum = 0.0;
  const auto& function = std::get<events::Function>(watched.event.function);
  const auto add_change_to = [&](double& argument, double there) {
    const double before = std::exchange(argument, there);
    const double value = function.f(t, std::span(y_.data(), n), std::span(y_.data() + n, n));
    argument = before;
    if (!std::isnan(value)) sum += std::abs(value - start);
  };
  const double moment =
      std::min(share_at_start * (std::abs(t) + std::abs(step.h)), 0x1p-12 * std::abs(step.h));
  add_change_to(t, t + std::copysign(moment, step.h));
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const double size = i < n ? 1.0 + std::abs(y_[i]) : rate;
    add_change_to(y_[i], y_[i] + std::copysign(share_at_start * size, step.row(1)[i]));
  }
  return sum;
}

/// Computes a TipLine or a Function at a state.
double EventFinder::value(Watched& watched, double t, const double* y) {
  if (watched.tip_line) return watched.tip_line->at(t, y);
  const auto n = static_cast<std::size_t>(n_);
  const double value =
      std::get<events::Function>(watched.event.function).f(t, std::span(y, n), std::span(y + n, n));
  if (!std::isnan(value)) return value;
  throw std::domain_error(event_name(watched.event, watched.number) + ": is NaN at t = " + text(t) +
                          " s: must be a number");
}

void EventFinder::find(Watched& watched, const Step& step) {
  roots_.clear();
  if (watched.difference) {
    find_difference(watched, *watched.difference, step);
  } else {
    find_value(watched, step);
  }
  for (const Root& root : roots_) {
    if (watched.event.direction != 0 && root.direction != watched.event.direction) continue;
    candidates_.push_back({root.theta, root.direction, watched.number});
  }
}

StepEnd EventFinder::look(const StepOutput& output, const double* rows, const TwoDouble& t_old,
                          double h, double t_new) {
  y_new_.resize(output.dimension());
  y_.resize(output.dimension());
  output.get_new_state(y_new_.data());
  const Step step{output, rows, t_old, h, t_new};
  candidates_.clear();
  at_the_end_.clear();
  for (Watched& one : watched_) {
    if (t_old.high != node_t_) one.unarmed_within = 0.0;
    if (too_many_of_ < 0) find(one, step);
  }
  if (too_many_of_ >= 0) {
    ended_by_ = too_many_of_;
    return StepEnd::too_many_turns();
  }
  node_t_ = t_new;
  std::copy_n(y_new_.begin(), node_y_.size(), node_y_.begin());
  std::ranges::sort(candidates_, [](const Candidate& a, const Candidate& b) {
    return std::tie(a.theta, a.event, a.direction) < std::tie(b.theta, b.event, b.direction);
  });
  double stop = 1.0;
  for (const Candidate& candidate : candidates_) {
    if (candidate.theta > stop) break;  // events at the same time are still found
    if (candidate.theta == 1.0) {
      at_the_end_.push_back(found_.size());
      append(candidate, t_new, y_new_.data());
    } else {
      output.state_within(rows, candidate.theta, y_.data());
      append(candidate, time_in_step(t_old, h, candidate.theta, t_new).high, y_.data());
    }
    if (ended_by_ >= 0) stop = candidate.theta;
  }
  return StepEnd::at(stop);
}

void EventFinder::append(const Candidate& candidate, double t, const double* y) {
  found_.push_back({.event = candidate.event,
                    .t = t,
                    .direction = candidate.direction,
                    .y = std::vector<double>(y, y + 2 * static_cast<std::ptrdiff_t>(n_)),
                    .y_before = {}});
  Watched& watched = watched_[candidate.event];
  ++watched.count;
  const long long terminal = watched.event.terminal;
  const bool ends = terminal > 0 && watched.count % terminal == 0 && watched.count > watched.passed;
  if (ends && ended_by_ < 0) ended_by_ = candidate.event;
}

void EventFinder::jump(double t, const double* before, const double* after) {
  const auto size = 2 * static_cast<std::ptrdiff_t>(n_);
  for (const std::size_t i : at_the_end_) {
    if (found_[i].t != t) continue;
    if (found_[i].y_before.empty()) found_[i].y_before.assign(before, before + size);
    found_[i].y.assign(after, after + size);
  }
  for (Watched& one : watched_) {
    bool is_armed = true;
    // A change of sign by a jump is an event. If the value before the jump was zero, the event was
    // found before, or was not armed.
    const auto cross = [&](double value_before, double value_after) {
      is_armed &= !one.is_within_rounding(value_after);
      const int from = sign(one.armed(value_before));
      if (from == 0 || sign(value_after) == from) return;
      const int direction = -from;
      if (one.event.direction != 0 && direction != one.event.direction) return;
      at_the_end_.push_back(found_.size());
      append({1.0, direction, one.number}, t, after);
      found_.back().y_before.assign(before, before + size);
    };
    if (one.difference) {
      const Difference& difference = *one.difference;
      const double there = difference.of(before);
      const double beyond = difference.of(after);
      const Levels levels =
          levels_between(difference, std::min(there, beyond), std::max(there, beyond));
      const int count = count_turns(one, levels);
      for (int i = 0; i < count; ++i) {
        const double level = levels.at(i);
        cross(difference.from(level, before), difference.from(level, after));
      }
    } else {
      const double value_before = value(one, t, before);
      one.node_value = value(one, t, after);
      cross(value_before, one.node_value);
    }
    if (is_armed) one.unarmed_within = 0.0;
  }
  node_t_ = t;
  std::copy_n(after, node_y_.size(), node_y_.begin());
}

}  // namespace pendcore
