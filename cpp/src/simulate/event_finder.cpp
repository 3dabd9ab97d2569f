#include "simulate/event_finder.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/pack.hpp"
#include "integrate/loop/integrate.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

constexpr double turn = 6.283185307179586;
constexpr double most_turns = 1e6;  // these take seconds, and fit into a list

}  // namespace

EventFinder::EventFinder(const Scene& scene, const std::vector<Event>& events,
                         std::vector<FoundEvent>& found, std::vector<long long> passed, double t0)
    : events_(events),
      found_(found),
      passed_(std::move(passed)),
      counts_(events.size()),
      tip_line_of_(events.size(), -1),
      n_(static_cast<int>(scene.links.size())),
      unarmed_within_(events.size()),
      t0_(t0),
      node_t_(t0),
      node_y_(2 * scene.links.size(), std::nan("")),
      node_values_(events.size()) {
  passed_.resize(events.size());
  for (const FoundEvent& one : found) ++counts_[one.event];
  // A continued run may begin between two changes at one time.
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].t == found.back().t) at_the_end_.push_back(i);
  }
  for (std::size_t k = 0; k < events.size(); ++k) {
    if (const auto* line = std::get_if<events::TipLine>(&events[k].function)) {
      tip_line_of_[k] = static_cast<int>(tip_lines_.size());
      tip_lines_.emplace_back(scene, *line);
    }
  }
}

bool EventFinder::may_end() const {
  return std::ranges::any_of(events_, [](const Event& event) {
    if (event.terminal > 0) return true;
    return std::visit(
        []<class Kind>(const Kind& one) {
          if constexpr (events::CountsTurns<Kind>) return one.every_turn;
          return std::is_same_v<Kind, events::Function>;
        },
        event.function);
  });
}

EventFinder::Difference EventFinder::difference_of(const EventFunction& function) const {
  const auto of_joint = [](int joint, int first) {
    return Difference{first + joint - 1, joint > 1 ? first + joint - 2 : -1};
  };
  const auto at_levels = [](Difference difference, const auto& angle) {
    difference.value = angle.value;
    difference.every_turn = angle.every_turn;
    return difference;
  };
  if (const auto* angle = std::get_if<events::JointAngle>(&function)) {
    return at_levels(of_joint(angle->joint, 0), *angle);
  }
  if (const auto* angle = std::get_if<events::LinkAngle>(&function)) {
    return at_levels({angle->link - 1, -1}, *angle);
  }
  const auto& rate = std::get<events::RateZero>(function);
  if (rate.joint) return of_joint(*rate.joint, n_);
  return {n_ + rate.link.value_or(1) - 1, -1};
}

std::vector<EventFinder::Difference> EventFinder::differences() const {
  std::vector<Difference> all;
  for (const Event& event : events_) {
    if (std::holds_alternative<events::TipLine>(event.function) ||
        std::holds_alternative<events::Function>(event.function)) {
      return {};
    }
    all.push_back(difference_of(event.function));
  }
  return all;
}

double EventFinder::Difference::from(double level, const double* y) const {
  const double x = of(y) - level;
  const double size = std::abs(y[plus]) + (minus < 0 ? 0.0 : std::abs(y[minus])) + std::abs(level);
  return std::abs(x) <= last_bits_share * size ? 0.0 : x;
}

double EventFinder::Levels::at(int i) const { return fma(first + i, turn, value); }

EventFinder::Levels EventFinder::levels_between(const Difference& difference, double low,
                                                double high) {
  const double value = difference.value;
  if (!difference.every_turn) return {value, 0.0, 1.0};
  const double from = (low - value) / turn;
  const double to = (high - value) / turn;
  const double margin = 1e-9 + last_bits_share * (std::abs(from) + std::abs(to));
  const double first = std::ceil(from - margin);
  return {value, first, std::floor(to + margin) - first + 1.0};
}

/// The levels that the difference may pass, within the bounds of its polynomial.
EventFinder::Levels EventFinder::levels_along(const Difference& difference, int degree, double end,
                                              double noise) {
  if (!difference.every_turn) return levels_between(difference, 0.0, 0.0);
  bernstein_.resize(polynomial_.size());
  bernstein_form(polynomial_.data(), degree, bernstein_.data());
  const auto [least, most] = std::ranges::minmax(bernstein_);
  return levels_between(difference, std::min(least, end) - noise, std::max(most, end) + noise);
}

/// The number of levels, or none once there were too many in this run. Turns beyond one a step are
/// counted, because max_steps does not bound them.
int EventFinder::count_turns(std::size_t k, const Levels& levels) {
  if (!(levels.count <= 1.0)) turns_ += levels.count - 1.0;
  if (turns_ <= most_turns) return static_cast<int>(levels.count);
  too_many_of_ = static_cast<int>(k);
  return 0;
}

void EventFinder::find_difference(std::size_t k, const Step& step) {
  const Difference difference = difference_of(events_[k].function);
  const int degree = step.output.interpolant_degree();
  const int dimension = step.output.dimension();
  polynomial_.resize(degree + 1);
  double size = 0.0;
  double moved = 0.0;
  double moved_with_its_links = 0.0;
  for (int p = 0; p <= degree; ++p) {
    const double* const row = step.rows + static_cast<std::ptrdiff_t>(p) * dimension;
    polynomial_[p] = difference.of(row);
    double size_of_row = std::abs(row[difference.plus]);
    if (difference.minus >= 0) size_of_row += std::abs(row[difference.minus]);
    size += size_of_row;
    if (p == 0) continue;
    moved += std::abs(polynomial_[p]);
    moved_with_its_links = std::max(moved_with_its_links, size_of_row);
  }
  if (step.t_old.high == t0_) unarmed_within_[k] = rounding_at_start(difference, step);
  // A held joint passes no level, whatever the last bits of its links' angles do.
  if (moved <= 64.0 * epsilon * moved_with_its_links) return;
  const double end = difference.of(y_new_.data());
  const Levels levels = levels_along(difference, degree, end, 8.0 * epsilon * size);
  const int count = count_turns(k, levels);
  bool is_armed = true;
  for (int i = 0; i < count; ++i) {
    const double level = levels.at(i);
    const double start = difference.from(level, step.rows);
    const double there = difference.from(level, y_new_.data());
    polynomial_[0] = armed_value(k, start);
    const double within = polynomial_[0] == 0.0 ? unarmed_within_[k] : 0.0;
    const double noise = std::max(8.0 * epsilon * (size + std::abs(level)), within);
    const bool has_left = find_roots(polynomial_.data(), degree, there, noise, roots_);
    is_armed &= has_left || std::abs(there) > within;
  }
  if (is_armed) unarmed_within_[k] = 0.0;
}

void EventFinder::find_tip_line(std::size_t k, const Step& step) {
  double start, end;
  node_values(k, step, start, end);
  const bool has_left = tip_lines_[tip_line_of_[k]].find(
      step.rows, step.output.interpolant_degree(), step.output.dimension(), step.t_old.high, step.h,
      armed_value(k, start), end, unarmed_within_[k], roots_);
  if (has_left || std::abs(end) > unarmed_within_[k]) unarmed_within_[k] = 0.0;
}

void EventFinder::find_function(std::size_t k, const events::Function& event, const Step& step) {
  double start, end;
  node_values(k, step, start, end);
  const double spaced = std::ceil(std::abs(step.h) / event.max_step);
  const int samples = static_cast<int>(std::clamp(spaced, double(event.samples), 1e6));
  samples_.clear();
  for (int i = 1; i < samples; ++i) {
    const double theta = static_cast<double>(i) / samples;
    samples_.push_back({theta, sampled(k, step, theta)});
  }
  // After the start, a value tells nothing of rounding: the function may jump.
  start = armed_value(k, start);
  unarmed_within_[k] = 0.0;
  find_roots([&](double theta) { return sampled(k, step, theta); }, start, samples_, end, 0.0,
             roots_);
}

/// The values at both ends of a step, for functions that cost more than a difference. The value at
/// the start is known from the step before.
void EventFinder::node_values(std::size_t k, const Step& step, double& start, double& end) {
  const bool is_known =
      node_t_ == step.t_old.high && std::equal(node_y_.begin(), node_y_.end(), step.rows);
  start = is_known ? node_values_[k] : function_at(k, step.t_old.high, step.rows);
  if (step.t_old.high == t0_) unarmed_within_[k] = rounding_at_start(k, step, start);
  if (std::abs(start) > unarmed_within_[k]) unarmed_within_[k] = 0.0;
  end = node_values_[k] = function_at(k, step.t_new, y_new_.data());
}

double EventFinder::sampled(std::size_t k, const Step& step, double theta) {
  step.output.sample(step.rows, {}, 1.0, &theta, 1, y_.data());
  return function_at(k, fma(theta, step.h, step.t_old.high), y_.data());
}

/// Computes a TipLine or a Function at a state.
double EventFinder::function_at(std::size_t k, double t, const double* y) {
  if (tip_line_of_[k] >= 0) return tip_lines_[tip_line_of_[k]].at(t, y);
  const auto n = static_cast<std::size_t>(n_);
  const double value =
      std::get<events::Function>(events_[k].function).f(t, std::span(y, n), std::span(y + n, n));
  if (!std::isnan(value)) return value;
  throw std::domain_error(event_name(events_[k], k) + ": is NaN at t = " + text(t) +
                          " s: must be a number");
}

void EventFinder::find(std::size_t k, const Step& step) {
  roots_.clear();
  const EventFunction& function = events_[k].function;
  if (tip_line_of_[k] >= 0) {
    find_tip_line(k, step);
  } else if (const auto* own = std::get_if<events::Function>(&function)) {
    find_function(k, *own, step);
  } else {
    find_difference(k, step);
  }
  for (const Root& root : roots_) {
    if (events_[k].direction != 0 && root.direction != events_[k].direction) continue;
    candidates_.push_back({root.theta, root.direction, static_cast<int>(k)});
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
  if (t_old.high != node_t_) std::ranges::fill(unarmed_within_, 0.0);
  for (std::size_t k = 0; k < events_.size() && too_many_of_ < 0; ++k) find(k, step);
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
      output.sample(rows, {}, 1.0, &candidate.theta, 1, y_.data());
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
  const long long count = ++counts_[candidate.event];
  const long long terminal = events_[candidate.event].terminal;
  const bool ends = terminal > 0 && count % terminal == 0 && count > passed_[candidate.event];
  if (ends && ended_by_ < 0) ended_by_ = candidate.event;
}

void EventFinder::jump(double t, const double* before, const double* after) {
  const auto size = 2 * static_cast<std::ptrdiff_t>(n_);
  for (const std::size_t i : at_the_end_) {
    if (found_[i].t != t) continue;
    if (found_[i].y_before.empty()) found_[i].y_before.assign(before, before + size);
    found_[i].y.assign(after, after + size);
  }
  for (std::size_t k = 0; k < events_.size(); ++k) {
    const EventFunction& function = events_[k].function;
    const bool is_difference =
        tip_line_of_[k] < 0 && !std::holds_alternative<events::Function>(function);
    if (!is_difference) {
      const double value_before = armed_value(k, function_at(k, t, before));
      node_values_[k] = function_at(k, t, after);
      if (std::abs(node_values_[k]) > unarmed_within_[k]) unarmed_within_[k] = 0.0;
      cross(k, value_before, node_values_[k], t, before, after);
      continue;
    }
    const Difference difference = difference_of(function);
    const double low = difference.of(before);
    const double high = difference.of(after);
    const Levels levels = levels_between(difference, std::min(low, high), std::max(low, high));
    const int count = count_turns(k, levels);
    bool is_armed = true;
    for (int i = 0; i < count; ++i) {
      const double level = levels.at(i);
      const double there = difference.from(level, after);
      is_armed &= std::abs(there) > unarmed_within_[k];
      cross(k, armed_value(k, difference.from(level, before)), there, t, before, after);
    }
    if (is_armed) unarmed_within_[k] = 0.0;
  }
  node_t_ = t;
  std::copy_n(after, node_y_.size(), node_y_.begin());
}

/// A change of sign by a jump is an event. If the value before the jump was zero, the event was
/// found before, or was not armed.
void EventFinder::cross(std::size_t k, double before, double after, double t,
                        const double* y_before, const double* y_after) {
  const int from = sign(before);
  const int to = sign(after);
  if (from == 0 || to == from) return;
  const int direction = -from;
  if (events_[k].direction != 0 && direction != events_[k].direction) return;
  at_the_end_.push_back(found_.size());
  append({1.0, direction, static_cast<int>(k)}, t, y_after);
  found_.back().y_before.assign(y_before, y_before + 2 * static_cast<std::ptrdiff_t>(n_));
}

}  // namespace pendcore
