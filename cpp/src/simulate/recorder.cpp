#include "simulate/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "scene/effects_of_scene.hpp"

namespace pendcore {

Recorder::Recorder(Solution& solution, const StepOutput& output, const Scene& scene,
                   const std::vector<long long>& passed_events)
    : solution_(solution),
      watch_(solution.options.watch),
      watch_asks_for_polynomials_(watch_ != nullptr && watch_->asks_for_dense_output()),
      may_throw_(has_functions(scene)),
      keeps_polynomials_(solution.options.store == Store::dense),
      keeps_steps_(solution.options.store == Store::steps ||
                   (keeps_polynomials_ && solution.options.t_eval.empty())),
      dimension_(static_cast<std::size_t>(output.dimension())),
      degree_(static_cast<std::size_t>(output.interpolant_degree())) {
  const std::vector<Event>& events = solution.options.events;
  if (!events.empty()) finder_.emplace(scene, events, solution.found, passed_events, solution.t0);
  solution_.t.reserve(solution_.options.t_eval.size());
  solution_.states.reserve(solution_.options.t_eval.size() * dimension_);
}

void Recorder::start(double t, const std::vector<double>& y) {
  if (watch_ != nullptr) watch_->starts(t, y);
  if (keeps_steps_ || is_asked_for(t)) std::ranges::copy(y, append(t));
}

StepEnd Recorder::step_accepted(StepOutput& output, const TwoDouble& t_old, double h,
                                double t_new) {
  StepEnd end;
  // This comes before anything is kept: it may evaluate right-hand sides, and a user's function may
  // throw.
  bool is_interpolated =
      finder_ || keeps_polynomials_ || (watch_asks_for_polynomials_ && may_throw_);
  if (is_interpolated) interpolate(output, h);
  if (finder_) {
    end = finder_->look(output, polynomial_.data(), t_old, h, t_new);
    if (end.has_too_many_turns()) return end;
  }
  const double t_end = end.is_within() ? time_in_step(t_old, h, end.theta, t_new).high : t_new;
  const auto get_end = [&](double* y) {
    if (end.is_within()) {
      output.state_within(polynomial_.data(), end.theta, y);
    } else {
      output.get_new_state(y);
    }
  };
  if (watch_ != nullptr) {
    shown_.resize(dimension_);
    get_end(shown_.data());
    const auto rows = [&] {
      if (!is_interpolated) interpolate(output, h);
      is_interpolated = true;
      return polynomial_.data();
    };
    watch_->steps({.t = t_end,
                   .h = h,
                   .y = shown_,
                   .rows = std::cref(rows),
                   .degree = static_cast<int>(degree_),
                   .share = end.is_within() ? end.theta : 1.0});
  }
  if (keeps_polynomials_ && t_end != t_old.high) {
    DenseOutput& dense = solution_.dense;
    dense.start.push_back(t_old.high);
    dense.start_low.push_back(t_old.low);
    dense.h.push_back(h);
    dense.coefficients.insert(dense.coefficients.end(), polynomial_.begin(), polynomial_.end());
  }
  if (!keeps_steps_) sample_before(output, t_old, h, t_end);
  const bool is_at_start = end.is_within() && !solution_.t.empty() && solution_.t.back() == t_end;
  if ((keeps_steps_ || is_asked_for(t_end)) && !is_at_start) get_end(append(t_end));
  return end;
}

void Recorder::interpolate(StepOutput& output, double h) {
  polynomial_.resize((degree_ + 1) * dimension_);
  output.finite_interpolant(h, polynomial_, dimension_);
}

/// Keeps the states before and after the jump, with the same time. If only times that were asked
/// for are kept, it keeps the state after the jump alone. An impact that changes no rate is not a
/// jump.
void Recorder::state_jumped(double t, const double* before, const double* after) {
  if (std::equal(before, before + 2 * solution_.n, after)) return state_settled(t, after);
  if (finder_) finder_->jump(t, before, after);
  if (keeps_steps_) {
    if (watch_ != nullptr) watch_->jumps(t, {after, dimension_});
    std::copy_n(after, dimension_, append(t));
  } else {
    state_settled(t, after);
  }
}

void Recorder::state_settled(double t, const double* after) {
  if (watch_ != nullptr) watch_->jumps(t, {after, dimension_});
  if (solution_.t.empty() || solution_.t.back() != t) return;
  std::copy_n(after, dimension_, solution_.states.end() - static_cast<std::ptrdiff_t>(dimension_));
}

Solution::Kept Recorder::kept() const {
  return {solution_.t.size(), solution_.dense.h.size(), solution_.found.size()};
}

/// Keeps the states at the times asked for that lie within a step, before t_end.
void Recorder::sample_before(StepOutput& output, const TwoDouble& t_old, double h, double t_end) {
  const std::vector<double>& samples = solution_.options.t_eval;
  const std::size_t first = solution_.t.size();
  std::size_t end = first;
  while (end < samples.size() && (samples[end] - t_end) * std::copysign(1.0, h) < 0.0) ++end;
  if (end == first) return;
  for (std::size_t k = first; k < end; ++k) solution_.t.push_back(samples[k]);
  solution_.states.resize(end * dimension_);
  interpolate(output, h);
  output.sample(polynomial_.data(), t_old, h, samples.data() + first, static_cast<int>(end - first),
                solution_.states.data() + first * dimension_);
}

/// Whether t is the next of the times asked for.
bool Recorder::is_asked_for(double t) const {
  const std::vector<double>& samples = solution_.options.t_eval;
  return solution_.t.size() < samples.size() && samples[solution_.t.size()] == t;
}

double* Recorder::append(double t) {
  solution_.t.push_back(t);
  solution_.states.resize(solution_.states.size() + dimension_);
  return solution_.states.data() + solution_.states.size() - dimension_;
}

}  // namespace pendcore
