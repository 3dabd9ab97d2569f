#include "analysis/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "analysis/changes_by_series.hpp"
#include "analysis/collocation_kernels.hpp"
#include "analysis/kinks_of_drag.hpp"
#include "analysis/saltation.hpp"
#include "arithmetic/epsilon.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/instruction_set.hpp"
#include "integrate/horner.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

constexpr int most_halvings_of_step = 44;
constexpr int most_cuts_of_step = 1000;
constexpr double negligible = 1e-3;  // of a step, beside its end, where drag may have a kink
/// The error that a step by collocation may add, as a share: 0.3 of what the run may, between
/// these. A series may add a third of it.
constexpr double least_tolerance = 1e-14;
constexpr double most_tolerance = 1e-8;

}  // namespace

struct Sensitivities::Variation {
  Variation(const Scene& scene, const std::vector<std::string>& names)
      : equations(scene, names), n(equations.links()), now(equations.changes_of_start()) {
    air.prepare(equations.scene(), equations.equations().effects.get());
    air.put(equations.scene());
  }

  void start(double t, std::span<const double> y);
  void take(const WatchedStep& step);
  void find_state(const WatchedStep& step, double share);
  bool follow_by_series(const WatchedStep& step, double share, double& from);
  void catch_up();
  void keep_end();
  void change_laws(const WatchedChange& change);
  void refuse_from(double t, const std::string& why);
  bool has_converged(double h);
  void advance(const WatchedStep& step, double from, double to, int halvings);
  int padded_names() const { return static_cast<int>((now.cols() + 3) / 4 * 4); }
  /// The share of a step at which the next time that is kept lies; infinite beyond the step.
  double next_share(const WatchedStep& step) const {
    const bool is_due = keeps_times && next_time < t_eval.size() &&
                        (t_eval[next_time] - step.t) * std::copysign(1.0, step.h) <= 0.0;
    if (!is_due) return std::numeric_limits<double>::infinity();
    return t_eval[next_time] == step.t ? step.share : (t_eval[next_time] - t_start) / step.h;
  }
  void keep(double t);
  void take_back_last() { values.resize(values.size() - static_cast<std::size_t>(now.size())); }

  VariationalEquations equations;
  EndsInAir<double> air{};
  std::optional<Saltation> saltation{};  ///< of a scene whose laws change
  int n;
  Matrix now;  ///< (2n, k); NaN where there are none
  double t_start = 0.0;
  std::vector<double> state{};  ///< of the run at t_start
  double tolerance = least_tolerance;

  // The series that is under way: it may serve many steps.
  ChangesBySeries series{};
  double since = 0.0;  ///< s, from where the series begins to t_start
  double reach = 0.0;  ///< s, from there to where it ends, negative in a backward run
  bool has_series = false;
  bool is_behind = false;  ///< whether the changes at t_start are still to be computed

  // The part of a step that is under way.
  bool has_points_to_spare = false;
  int points_at_once = 8;
  int cuts_left = 0;  ///< into which the step may still be cut
  std::vector<double> thetas{}, states{}, decay{};
  Vector floor{};            ///< what rounding alone makes of d qdd/d p, (k), by epsilon
  Vector sizes_elsewhere{};  ///< once they have been needed
  Matrix by_q{}, by_qd{}, by_parameters{}, by_name{}, padded{}, system{};

  bool has_started = false;
  bool keeps_end = true;
  bool keeps_times = false;
  bool is_over = false;  ///< no name has a derivative any more
  std::vector<double> t_eval{};
  std::size_t next_time = 0;
  double t_kept = std::numeric_limits<double>::quiet_NaN();  ///< s, of the last values
  std::vector<double> values{};
  std::string refusal{};
};

void Sensitivities::Variation::keep(double t) {
  if (keeps_end) return;
  values.insert(values.end(), now.data(), now.data() + now.size());
  t_kept = t;
}

/// From a time on, there are no derivatives.
void Sensitivities::Variation::refuse_from(double t, const std::string& why) {
  refusal = "sensitivities: none after t = " + text(t) + " s: " + why;
  is_over = true;
  has_series = is_behind = false;
  now.setConstant(std::numeric_limits<double>::quiet_NaN());
}

/// Whether d(dqd)/dt is a polynomial: by the last two of Legendre's coefficients, for each name
/// alone. Where they fall like a geometric series, the error at the end of the step is of the order
/// of their square. At a kink they do not. Notes whether fewer points would have done.
bool Sensitivities::Variation::has_converged(double h) {
  constexpr double fewer = 1e-3;  // a point less leaves larger last coefficients
  has_points_to_spare = true;
  const int width = padded_names();
  floor.setZero(now.cols());
  for (std::size_t p = 0; p < equations.parameters().size(); ++p) {
    const auto& one = equations.parameters()[p];
    const double elsewhere = sizes_elsewhere.size() == 0 ? 0.0 : sizes_elsewhere[p];
    floor[one.column] = std::max(equations.size_of(one), elsewhere);
  }
  for (int k = 0; k < now.cols(); ++k) {
    if (!now.col(k).allFinite()) continue;
    const double largest = decay[k], last = decay[width + k], middle = decay[2 * width + k];
    if (!std::isfinite(largest)) return false;
    const double size = now.col(k).cwiseAbs().maxCoeff() + std::abs(h) * largest;
    const bool falls = last * largest <= 10.0 * middle * middle;
    const double allowed = (falls ? 0.3 * std::sqrt(tolerance) : tolerance) * size;
    if (std::abs(h) * (last - 16.0 * epsilon * floor[k]) > allowed) return false;
    // Far below what is allowed, rounding is all that is left, and does not fall.
    const double spare = fewer * 0.3 * std::sqrt(tolerance) * size;
    has_points_to_spare &= std::abs(h) * (last - 16.0 * epsilon * floor[k]) <= spare;
  }
  return true;
}

/// Advances through the part of a step between two shares of it.
void Sensitivities::Variation::advance(const WatchedStep& step, double from, double to,
                                       int halvings) {
  const GaussCollocation& points = gauss_collocation(points_at_once);
  const int s = points.s;
  const double h = (to - from) * step.h;
  const auto size = static_cast<int>(step.y.size());
  thetas.resize(s);
  states.resize(static_cast<std::size_t>(s) * size);
  for (int i = 0; i < s; ++i) thetas[i] = from + points.theta[i] * (to - from);
  static const auto sample = fastest<&sample_rows>();
  sample(step.rows(), {}, 1.0, thetas.data(), s, states.data(), size, step.degree);

  const int width = padded_names();
  const int row = (n * s + 3) / 4 * 4 + width;
  const auto parameters = static_cast<Eigen::Index>(equations.parameters().size());
  by_q.resize(s * n, n);
  by_qd.resize(s * n, n);
  by_parameters.resize(n, parameters);
  by_name.setZero(s * n, width);
  system.resize(n * s, row);
  decay.resize(3 * static_cast<std::size_t>(width));
  for (int i = 0; i < s; ++i) {
    equations.at(t_start + thetas[i] * step.h, &states[static_cast<std::size_t>(i) * size],
                 by_q.middleRows(i * n, n), by_qd.middleRows(i * n, n), by_parameters);
    for (Eigen::Index p = 0; p < parameters; ++p) {
      by_name.block(i * n, equations.parameters()[p].column, n, 1) = by_parameters.col(p);
    }
  }
  padded.setZero(2 * n, width);
  padded.leftCols(now.cols()) = now;
  const CollocationStep part{.points = &points,
                             .n = n,
                             .width = width,
                             .row = row,
                             .h = h,
                             .by_q = by_q.data(),
                             .by_qd = by_qd.data(),
                             .by_name = by_name.data(),
                             .now = padded.data(),
                             .system = system.data(),
                             .decay = decay.data()};
  static const auto solve = fastest<&solve_step>();
  solve(&part);  // d(dqd)/dt at the points

  if (!has_converged(h)) {
    if (points_at_once < most_points) {
      points_at_once = std::min(points_at_once + 3, most_points);
      return advance(step, from, to, halvings);
    }
    // At an equilibrium, all that is there may be what the last bits of the angles leave.
    if (halvings == 4 && sizes_elsewhere.size() == 0 && !equations.parameters().empty()) {
      sizes_elsewhere = equations.sizes_elsewhere(t_start, states.data());
      return advance(step, from, to, halvings);
    }
    const double middle = 0.5 * (from + to);
    if (halvings == most_halvings_of_step || --cuts_left < 0 || middle == from || middle == to) {
      refuse_from(t_start + from * step.h,
                  "the motion has a corner there, or grows beyond numbers");
      return;
    }
    advance(step, from, middle, halvings + 1);
    if (!is_over) advance(step, middle, to, halvings + 1);
    return;
  }
  if (has_points_to_spare && points_at_once > least_points) --points_at_once;
  static const auto end = fastest<&end_step>();
  end(&part);
  now = padded.leftCols(now.cols());
}

void Sensitivities::Variation::start(double t, std::span<const double> y) {
  if (has_started) throw std::invalid_argument("sensitivities: have seen a run already");
  if (y.size() < static_cast<std::size_t>(2 * n)) {
    throw std::invalid_argument("sensitivities: are for a scene with more links than the run's");
  }
  has_started = true;
  t_start = t;
  state.assign(y.begin(), y.end());
  equations.choose_laws(t, y.data());
  const bool is_asked_for = !t_eval.empty() && t_eval.front() == t;
  if (is_asked_for) ++next_time;
  if (!keeps_times || is_asked_for) keep(t);
}

/// The run's state at a share of a step. A series from before the step has it but for an error that
/// is known at the start of the step: closer than the dense output of most methods.
void Sensitivities::Variation::find_state(const WatchedStep& step, double share) {
  const auto size = static_cast<int>(step.y.size());
  states.resize(step.y.size());
  if (share == 0.0) {
    states = state;
  } else if (has_series && since / step.h >= 0.0) {
    std::vector<double> at_start(step.y.size());
    series.state(since, at_start.data());
    series.state(since + share * step.h, states.data());
    for (int i = 0; i < 2 * n; ++i) states[i] += state[i] - at_start[i];
  } else {
    static const auto sample = fastest<&sample_rows>();
    sample(step.rows(), {}, 1.0, &share, 1, states.data(), size, step.degree);
  }
}
/// Goes on by series, one after another, each from where the last one ends, until one reaches a
/// share of a step. Returns whether one does. If there is none, or the next would be too short, the
/// changes are those at the share `from`.
bool Sensitivities::Variation::follow_by_series(const WatchedStep& step, double share,
                                                double& from) {
  constexpr double least_part = 1.0 / 8.0;  // of a step; below, collocation takes less time
  constexpr double rounding = 1e-9;         // of a step
  for (;;) {
    const double end = has_series ? (reach - since) / step.h : 0.0;
    if (has_series && end >= share - rounding) return true;
    from = std::max(end, 0.0);
    find_state(step, from);
    if (has_series) {
      series.move_start(since + from * step.h);
    } else if (!series.start(equations, now, 2.0 * std::abs(step.h), tolerance / 3.0)) {
      return false;
    }
    const double span = series.expand(t_start + from * step.h, states.data(), step.h > 0.0);
    has_series = span >= least_part * std::abs(step.h);
    if (!has_series) {
      series.evaluate(0.0, now);
      return false;
    }
    reach = std::copysign(span, step.h);
    since = -from * step.h;
  }
}
/// Computes the changes where the run is.
void Sensitivities::Variation::catch_up() {
  if (is_behind) series.evaluate(since, now);
  is_behind = false;
}
/// Keeps the changes where the run is, if it keeps its end alone.
void Sensitivities::Variation::keep_end() {
  if (!keeps_end) return;
  catch_up();
  values.assign(now.data(), now.data() + now.size());
}

void Sensitivities::Variation::take(const WatchedStep& step) {
  if (step.share == 0.0) return;  // an event at the start of a step
  cuts_left = most_cuts_of_step;
  std::vector<Saltation::NearMiss> misses;
  std::size_t next_miss = 0;
  if (saltation && !is_over) misses = saltation->near_misses(step);
  bool by_series = true;
  double from = 0.0;  // where the changes are, if they go on by collocation
  std::optional<std::vector<double>> kinks;
  const auto has_followed = [&](double to) {
    by_series = by_series && follow_by_series(step, to, from);
    return by_series;
  };
  // By collocation, a time that is kept is the end of a part: there, the order is highest.
  const auto go_straight_to = [&](double to) {
    if (has_followed(to)) {
      series.evaluate(since + to * step.h, now);
    } else if (to > from) {
      if (!kinks) kinks = kinks_of_drag(air, step, t_start);
      std::vector<double> ends;
      std::ranges::copy_if(*kinks, std::back_inserter(ends), [&](double kink) {
        return from + negligible < kink && kink < to - negligible;
      });
      ends.push_back(to);
      for (const double end : ends) {
        if (!is_over) advance(step, from, end, 0);
        from = end;
      }
    }
  };
  const auto pass_misses = [&](double to) {
    for (; !is_over && next_miss < misses.size() && misses[next_miss].share < to; ++next_miss) {
      const Saltation::NearMiss& miss = misses[next_miss];
      go_straight_to(miss.share);
      const std::string why = is_over ? "" : saltation->why_none(miss, now);
      if (!why.empty()) refuse_from(t_start + miss.share * step.h, why);
    }
  };
  for (; std::isfinite(next_share(step)); ++next_time) {
    const double to = next_share(step);
    pass_misses(to);
    if (!is_over) go_straight_to(to);
    keep(t_eval[next_time]);
  }
  pass_misses(step.share);
  if (!is_over) {
    is_behind = has_followed(step.share);
    if (!is_behind) go_straight_to(step.share);
  }
  since += step.share * step.h;
  t_start = step.t;
  state.assign(step.y.begin(), step.y.end());
  if (keeps_times || keeps_end) return;
  catch_up();
  keep(step.t);
}

/// The run keeps a state after a jump beside the one before it, where it keeps its steps; otherwise
/// the state after takes its place.
void Sensitivities::Variation::change_laws(const WatchedChange& change) {
  catch_up();
  has_series = false;
  sizes_elsewhere.resize(0);
  std::ranges::copy(change.after, state.begin());
  if (!saltation) saltation.emplace(equations);
  if (!is_over) {
    try {
      if (change.at_start) {
        refusal = saltation->start(change, now);
        is_over = !now.array().isFinite().any();
      } else if (const std::string why = saltation->pass(change, now); !why.empty()) {
        refuse_from(change.t, why);
      } else if (const std::string told = saltation->take_remark(); !told.empty()) {
        refusal.append(refusal.empty() ? "" : "; ").append(told);
      }
    } catch (const std::invalid_argument& error) {
      refuse_from(change.t, error.what());
    }
  }
  const bool keeps_steps = !keeps_end && !keeps_times;
  if (t_kept != change.t && !(keeps_steps && change.jumped)) return;
  if (!(keeps_steps && change.jumped)) take_back_last();
  keep(change.t);
}

Sensitivities::Sensitivities(const Scene& scene, const std::vector<std::string>& names) {
  const FloatingPointEnvironment ieee;
  variation_ = std::make_unique<Variation>(scene, names);
}
Sensitivities::~Sensitivities() = default;
Sensitivities::Sensitivities(Sensitivities&&) noexcept = default;

void Sensitivities::keep(Store store, const Options& options) {
  variation_->keeps_end = store == Store::end;
  variation_->keeps_times =
      store == Store::times || (store == Store::dense && !options.t_eval.empty());
  variation_->t_eval = options.t_eval;
  const double rtol = options.step ? 0.0 : *std::ranges::min_element(options.rtol);
  variation_->tolerance = std::clamp(0.3 * rtol, least_tolerance, most_tolerance);
}

void Sensitivities::starts(double t, std::span<const double> y) { variation_->start(t, y); }
void Sensitivities::steps(const WatchedStep& step) { variation_->take(step); }
void Sensitivities::changes(const WatchedChange& change) { variation_->change_laws(change); }

const std::string& Sensitivities::refusal() const { return variation_->refusal; }
const std::vector<double>& Sensitivities::values() const {
  const FloatingPointEnvironment ieee;
  variation_->keep_end();
  return variation_->values;
}
std::size_t Sensitivities::states() const { return static_cast<std::size_t>(2 * variation_->n); }
std::size_t Sensitivities::names() const {
  return static_cast<std::size_t>(variation_->now.cols());
}

}  // namespace pendcore
