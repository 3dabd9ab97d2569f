#include "pendcore/lyapunov.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "analysis/tangent_stepper.hpp"
#include "arithmetic/exponential.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "integrate/loop/first_step.hpp"
#include "integrate/loop/integrate.hpp"
#include "integrate/loop/interruption.hpp"
#include "pendcore/options.hpp"
#include "scene/effects_of_scene.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/initial_state.hpp"
#include "text/message.hpp"

namespace pendcore {

namespace {

/// An orthonormal basis of the small changes that locks allow, (2m, 2n), each row a change (dq,
/// dqd): for each of the m groups of links that turn together, a change of its angles, and then for
/// each a change of its rates. Links that are locked to the ground do not turn.
Matrix tangent_basis(const Scene& scene) {
  const int n = static_cast<int>(scene.links.size());
  const std::vector<bool> locked = locked_joints(scene);
  Matrix turns = Matrix::Zero(n, n);
  Eigen::Index groups = 0;
  for (int first = 0; first < n;) {
    int end = first + 1;
    while (end < n && locked[end]) ++end;
    const int count = end - first;
    if (!locked[first]) turns.row(groups++).segment(first, count).fill(1.0 / std::sqrt(count));
    first = end;
  }
  Matrix basis = Matrix::Zero(2 * groups, 2 * n);
  basis.topLeftCorner(groups, n) = basis.bottomRightCorner(groups, n) = turns.topRows(groups);
  return basis;
}

/// Makes the rows of `vectors` orthonormal by the Gram-Schmidt process, applied twice so that it is
/// exact to rounding. The rows of `alike` go through the same linear combinations. Returns the
/// diagonal of R: the length of each row without its components along those before. It is positive,
/// which that of Eigen's HouseholderQR is not. The changes belong to the trajectory: each sum runs
/// from the first number to the last, as Eigen's do without packets (DefaultTraversal in Redux.h).
Vector orthonormalise(Matrix& vectors, Matrix& alike) {
  Vector lengths(vectors.rows());
  for (Eigen::Index j = 0; j < vectors.rows(); ++j) {
    auto v = vectors.row(j);
    auto w = alike.row(j);
    for (int pass = 0; pass < 2; ++pass) {
      for (Eigen::Index before = 0; before < j; ++before) {
        const double along = v.dot(vectors.row(before));
        v -= along * vectors.row(before);
        w -= along * alike.row(before);
      }
    }
    lengths[j] = v.norm();
    v /= lengths[j];
    w /= lengths[j];
  }
  return lengths;
}

/// The rows (q, dq_1 .. dq_k) and (qd, dqd_1 .. dqd_k) of a state of tangent_stepper.hpp.
class RowsOfTangents {
 public:
  RowsOfTangents(int links, int count) : n(links), k(count) {}

  Eigen::Index dimension() const { return 2 * half(); }
  Vector motion(const Vector& y) const {
    Vector both(2 * n);
    both << y.head(n), y.segment(half(), n);
    return both;
  }
  template <class Angles, class Rates>
  void set_motion(const Angles& q, const Rates& qd, Vector& y) const {
    y.head(n) = q;
    y.segment(half(), n) = qd;
  }
  /// Copies the changes (dq, dqd), (k, 2n), from a state, and back.
  void get_changes(const Vector& y, Matrix& changes) const {
    changes.leftCols(n) = Eigen::Map<const Matrix>(y.data() + n, k, n);
    changes.rightCols(n) = Eigen::Map<const Matrix>(y.data() + half() + n, k, n);
  }
  void set_changes(const Matrix& changes, Vector& y) const {
    Eigen::Map<Matrix>(y.data() + n, k, n) = changes.leftCols(n);
    Eigen::Map<Matrix>(y.data() + half() + n, k, n) = changes.rightCols(n);
  }

  const Eigen::Index n, k;

 private:
  Eigen::Index half() const { return n * (1 + k); }
};

Vector logarithms(const Vector& lengths) {
  return lengths.unaryExpr([](double length) { return logarithm(length); });
}

/// Sums up the growth, and records it at the times asked for.
class GrowthRecorder final : public Observer {
 public:
  GrowthRecorder(Stepper& stepper, const RowsOfTangents& rows, const std::vector<double>& times,
                 TangentGrowth& result)
      : stepper_(stepper),
        rows_(rows),
        times_(times),
        result_(result),
        sums_(Vector::Zero(rows.k)),
        state_(rows.dimension()),
        rate_(rows.dimension()),
        changes_(rows.k, 2 * rows.n),
        slopes_(changes_) {}

  void start(double t, const std::vector<double>& y) {
    state_ = View(y.data(), state_.size());
    if (next_ < times_.size() && times_[next_] == t) keep(t);
  }
  StepEnd step_accepted(StepOutput& step, const TwoDouble& t_old, double h, double t_new) override {
    polynomial_.clear();
    was_stepped_ = true;
    while (next_ < times_.size() && (times_[next_] - t_new) * std::copysign(1.0, h) <= 0.0) {
      const double t = times_[next_];
      if (t == t_new) {
        step.get_new_state(state_.data());
      } else {
        interpolate(step, t_old, h, t);
      }
      keep(t);
    }
    return {};
  }
  void state_jumped(double, const double*, const double*) override {}
  void restarts_here() override {}

  /// The loop then calls step_begins() before each step, where the stepper has the state that was
  /// reached.
  bool may_end() const override { return true; }
  void step_begins() override {
    if (!was_stepped_) return;
    was_stepped_ = false;
    stepper_.get_state(state_.data());
    stepper_.get_derivative(rate_.data());
    rows_.get_changes(state_, changes_);
    rows_.get_changes(rate_, slopes_);
    // The derivatives of the changes are linear in the changes, so nothing needs to be evaluated
    // again.
    const Vector lengths = orthonormalise(changes_, slopes_);
    const auto is_near_one = [](double length) { return 1.0 / far < length && length < far; };
    if (std::ranges::all_of(lengths, is_near_one)) return;
    sums_ += logarithms(lengths);
    rows_.set_changes(changes_, state_);
    rows_.set_changes(slopes_, rate_);
    stepper_.start(state_.data(), rate_.data());
  }

 private:
  void interpolate(StepOutput& step, const TwoDouble& t_old, double h, double t) {
    if (polynomial_.empty()) {
      polynomial_.resize(static_cast<std::size_t>(step.interpolant_degree() + 1) *
                         step.dimension());
      step.finite_interpolant(h, polynomial_, step.dimension());
    }
    step.sample(polynomial_.data(), t_old, h, &t, 1, state_.data());
  }
  void keep(double t) {
    rows_.get_changes(state_, changes_);
    slopes_ = changes_;
    const Vector growth = sums_ + logarithms(orthonormalise(changes_, slopes_));
    const Vector motion = rows_.motion(state_);
    result_.t.push_back(t);
    result_.growth.insert(result_.growth.end(), growth.begin(), growth.end());
    result_.states.insert(result_.states.end(), motion.begin(), motion.end());
    ++next_;
  }

  /// As long as R_ii are within [1/far, far], the changes stay as they are: then a series that ends
  /// a step begins the next. Beyond, absolute tolerances would no longer suit their lengths.
  static constexpr double far = 16.0;

  Stepper& stepper_;
  const RowsOfTangents& rows_;
  const std::vector<double>& times_;
  TangentGrowth& result_;
  std::size_t next_ = 0;
  bool was_stepped_ = false;
  Vector sums_;
  Vector state_, rate_;
  Matrix changes_, slopes_;
  std::vector<double> polynomial_;  ///< of the last step; empty until it is needed
};

/// The options of the run, checked like the options of a simulation.
Options options_of_run(const LyapunovOptions& options) {
  Options run;
  run.rtol = {options.rtol};
  run.atol = {options.atol};
  run.max_step = options.max_step;
  run.max_steps = options.max_steps;
  run.time_limit = options.time_limit;
  check(run);
  return run;
}

std::vector<double> times_of_growth(const LyapunovOptions& options, double t0, double t_end) {
  const double since = options.since.value_or(t0);
  std::vector<double> times = options.t_eval;
  if (times.empty()) times = {t_end};
  check_times(times, since, t_end);
  if (times.back() == since && since != t_end) {
    refuse("t_eval", since, "followed by later times (s): growth counts from there");
  }
  if (times.front() != since) times.insert(times.begin(), since);
  return times;
}

}  // namespace

void check_has_exponents(const Scene& scene) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    if (!scene.effects[i].info().jumps_or_sticks) continue;
    throw std::invalid_argument(
        effect_name(scene, i) +
        ": motions jump or stick under it, each at a time of its own, so neighbouring motions do "
        "not diverge at a rate: remove dry friction and stops to get exponents; sol.valid_until() "
        "and pendcore.horizon_work tell how long a run is right with them, too");
  }
}

TangentGrowth lyapunov(const Scene& scene, const Numbers& q0, const Numbers& qd0, double t0,
                       double t_end, const LyapunovOptions& options) {
  const FloatingPointEnvironment ieee;
  check(scene);
  check_start(scene, q0.span(), qd0.span(), t0, t_end);
  check_has_exponents(scene);
  const Matrix basis = tangent_basis(scene);
  const int n = static_cast<int>(scene.links.size());
  const int all = static_cast<int>(basis.rows());
  const long long wanted = options.count.value_or(all);
  if (wanted > all || (options.count && wanted < 1)) {
    throw std::invalid_argument(
        "count = " + std::to_string(wanted) + ": must be " +
        (all == 0 ? "left out: nothing of the scene can move"
                  : "1 to " + std::to_string(all) + ", twice the degrees of freedom"));
  }
  const Options run = options_of_run(options);
  const std::vector<double> times = times_of_growth(options, t0, t_end);

  TangentGrowth result;
  result.count = static_cast<int>(wanted);
  const RowsOfTangents rows(n, result.count);
  const std::unique_ptr<Stepper> made = tangent_stepper(scene, result.count, t_end, !(t_end < t0));
  Stepper& stepper = *made;

  IntegratorState integrator;
  integrator.t = {t0, 0.0};
  Vector y(rows.dimension());
  rows.set_motion(q0, qd0, y);
  rows.set_changes(basis.topRows(rows.k), y);
  integrator.y.assign(y.begin(), y.end());
  integrator.dydt.resize(integrator.y.size());
  const double rtol = relative_tolerances(run, n)[0];
  const Vector relative = Vector::Constant(y.size(), rtol);
  const Vector of_motion = Vector::Constant(n, absolute_tolerances(run, n)[0]);
  Vector absolute = relative;
  rows.set_motion(of_motion, of_motion, absolute);
  stepper.set_tolerances(relative.data(), absolute.data());

  GrowthRecorder recorder(stepper, rows, times, result);
  const Limits limits{.t_end = t_end,
                      .max_step = options.max_step,
                      .max_steps = options.max_steps,
                      .time_limit = options.time_limit,
                      .monitor = options.monitor};
  Ending ending{.status = Status::finished, .cut = false};
  const Interruption found = interruption_of([&] {
    stepper.evaluate(t0, integrator.y.data(), integrator.dydt.data());
    stepper.start(integrator.y.data(), integrator.dydt.data());
    recorder.start(t0, integrator.y);
    if (t0 == t_end) return;
    const double h =
        first_step(stepper, t0, t_end, options.max_step, relative.data(), absolute.data()).h;
    integrator.h = t_end < t0 ? -h : h;
    IntegratorState resumable = integrator;
    ending = integrate(stepper, integrator, resumable, limits, recorder, nullptr);
  });
  if (found.status != Status::finished) {
    ending.status = found.status;
    ending.error = found.error;
  }
  result.status = ending.status;
  result.message = text(ending.status).sentence;
  result.statistics = integrator.statistics;
  result.t_reached = integrator.t.high;
  result.error = ending.error;
  if (!text(ending.status).success) {
    result.message += " (at t = " + text(result.t_reached) + " s)";
  }
  return result;
}

}  // namespace pendcore
