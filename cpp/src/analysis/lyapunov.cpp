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
#include "integrate/loop/run_limits.hpp"
#include "pendcore/options.hpp"
#include "scene/effects_of_scene.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/initial_state.hpp"
#include "text/message.hpp"

namespace pendcore {

namespace {

/// An orthonormal basis of the small changes that locks allow, (2m, 2n) row-major, each row a
/// change (dq, dqd): for each of the m groups of links that turn together, a change of its angles,
/// and then for each a change of its rates. Links that are locked to the ground do not turn.
std::vector<double> tangent_basis(const Scene& scene) {
  const int n = static_cast<int>(scene.links.size());
  const std::vector<bool> locked = locked_joints(scene);
  std::vector<double> basis;
  for (const int part : {0, n}) {
    for (int first = 0; first < n;) {
      int end = first + 1;
      while (end < n && locked[end]) ++end;
      if (!locked[first]) {
        const std::size_t row = basis.size();
        basis.resize(row + 2 * static_cast<std::size_t>(n));
        for (int i = first; i < end; ++i) basis[row + part + i] = 1.0 / std::sqrt(end - first);
      }
      first = end;
    }
  }
  return basis;
}

/// Makes the rows of `vectors`, (k, size) row-major, orthonormal by the Gram-Schmidt process,
/// applied twice so that it is exact to rounding. The rows of `alike` go through the same linear
/// combinations. `length` (k) becomes the diagonal of R: the length of each row without its
/// components along the rows before.
void orthonormalise(int k, int size, double* vectors, double* alike, double* length) {
  auto dot = [size](const double* a, const double* b) {
    double sum = 0.0;
    for (int i = 0; i < size; ++i) sum += a[i] * b[i];
    return sum;
  };
  for (int j = 0; j < k; ++j) {
    double* const v = vectors + j * size;
    double* const w = alike + j * size;
    for (int pass = 0; pass < 2; ++pass) {
      for (int before = 0; before < j; ++before) {
        const double along = dot(v, vectors + before * size);
        for (int i = 0; i < size; ++i) {
          v[i] -= along * vectors[before * size + i];
          w[i] -= along * alike[before * size + i];
        }
      }
    }
    length[j] = std::sqrt(dot(v, v));
    for (int i = 0; i < size; ++i) {
      v[i] /= length[j];
      w[i] /= length[j];
    }
  }
}

/// Sums up the growth, and records it at the times asked for.
class GrowthRecorder final : public Observer {
 public:
  GrowthRecorder(Stepper& stepper, int n, const std::vector<double>& times, TangentGrowth& result)
      : stepper_(stepper),
        n_(n),
        k_(result.count),
        times_(times),
        result_(result),
        sums_(k_),
        lengths_(k_),
        state_(stepper.dimension()),
        rate_(stepper.dimension()),
        changes_(static_cast<std::size_t>(k_) * 2 * n),
        slopes_(changes_.size()) {}

  void start(double t, const std::vector<double>& y) {
    if (next_ < times_.size() && times_[next_] == t) keep(t, y);
  }
  StepEnd step_accepted(StepOutput& step, const TwoDouble& t_old, double h, double t_new) override {
    has_polynomial_ = false;
    was_stepped_ = true;
    while (next_ < times_.size() && (times_[next_] - t_new) * h <= 0.0) {
      const double t = times_[next_];
      if (t == t_new) {
        step.get_new_state(state_.data());
      } else {
        interpolate(step, t_old, h, t);
      }
      keep(t, state_);
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
    gather(state_, changes_);
    gather(rate_, slopes_);
    // The derivatives of the changes are linear in the changes, so nothing needs to be evaluated
    // again.
    orthonormalise(k_, 2 * n_, changes_.data(), slopes_.data(), lengths_.data());
    const auto is_near_one = [](double length) { return 1.0 / far < length && length < far; };
    if (std::ranges::all_of(lengths_, is_near_one)) return;
    for (int i = 0; i < k_; ++i) sums_[i] += logarithm(lengths_[i]);
    scatter(changes_, state_);
    scatter(slopes_, rate_);
    stepper_.start(state_.data(), rate_.data());
  }

 private:
  void interpolate(StepOutput& step, const TwoDouble& t_old, double h, double t) {
    if (!has_polynomial_) {
      polynomial_.resize(static_cast<std::size_t>(step.interpolant_degree() + 1) *
                         step.dimension());
      step.finite_interpolant(h, polynomial_, step.dimension());
      has_polynomial_ = true;
    }
    step.sample(polynomial_.data(), t_old, h, &t, 1, state_.data());
  }
  void keep(double t, const std::vector<double>& y) {
    gather(y, changes_);
    slopes_ = changes_;
    orthonormalise(k_, 2 * n_, changes_.data(), slopes_.data(), lengths_.data());
    result_.t.push_back(t);
    for (int i = 0; i < k_; ++i) result_.growth.push_back(sums_[i] + logarithm(lengths_[i]));
    const auto q = y.begin();
    const auto qd = q + half();
    result_.states.insert(result_.states.end(), q, q + n_);
    result_.states.insert(result_.states.end(), qd, qd + n_);
    ++next_;
  }
  std::ptrdiff_t half() const { return static_cast<std::ptrdiff_t>(n_) * (1 + k_); }
  /// gather() copies the changes from the two halves of a state to rows (dq, dqd); scatter() copies
  /// them back.
  void gather(const std::vector<double>& y, std::vector<double>& rows) const {
    for (int i = 0; i < k_; ++i) {
      const auto dq = y.begin() + static_cast<std::ptrdiff_t>(i + 1) * n_;
      const auto row = rows.begin() + static_cast<std::ptrdiff_t>(i) * 2 * n_;
      std::copy_n(dq, n_, row);
      std::copy_n(dq + half(), n_, row + n_);
    }
  }
  void scatter(const std::vector<double>& rows, std::vector<double>& y) const {
    for (int i = 0; i < k_; ++i) {
      const auto dq = y.begin() + static_cast<std::ptrdiff_t>(i + 1) * n_;
      const auto row = rows.begin() + static_cast<std::ptrdiff_t>(i) * 2 * n_;
      std::copy_n(row, n_, dq);
      std::copy_n(row + n_, n_, dq + half());
    }
  }

  /// As long as R_ii are within [1/far, far], the changes stay as they are: then a series that ends
  /// a step begins the next. Beyond, absolute tolerances would no longer suit their lengths.
  static constexpr double far = 16.0;

  Stepper& stepper_;
  int n_;
  int k_;
  const std::vector<double>& times_;
  TangentGrowth& result_;
  std::size_t next_ = 0;
  bool was_stepped_ = false;
  bool has_polynomial_ = false;
  std::vector<double> sums_, lengths_;
  std::vector<double> state_, rate_;
  std::vector<double> changes_, slopes_;
  std::vector<double> polynomial_;
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

int lyapunov_count(const Scene& scene) {
  return static_cast<int>(tangent_basis(scene).size() / (2 * scene.links.size()));
}

namespace {

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

TangentGrowth lyapunov(const Scene& scene, const Numbers& q0, const Numbers& qd0, double t0,
                       double t_end, const LyapunovOptions& options) {
  const FloatingPointEnvironment ieee;
  check(scene);
  check_start(scene, q0.span(), qd0.span(), t0, t_end);
  check_has_exponents(scene);
  const std::vector<double> basis = tangent_basis(scene);
  const int n = static_cast<int>(scene.links.size());
  const int all = static_cast<int>(basis.size()) / (2 * n);
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
  const int numbers = n * (1 + result.count);
  const std::unique_ptr<Stepper> made = tangent_stepper(scene, result.count, t_end, !(t_end < t0));
  Stepper& stepper = *made;

  IntegratorState integrator;
  integrator.t = {t0, 0.0};
  integrator.y.resize(2 * static_cast<std::size_t>(numbers));
  integrator.dydt.resize(integrator.y.size());
  const double rtol = relative_tolerances(run, n)[0];
  const std::vector<double> relative(integrator.y.size(), rtol);
  std::vector<double> absolute(integrator.y.size(), rtol);
  const double atol = absolute_tolerances(run, n)[0];
  for (int i = 0; i < n; ++i) {
    integrator.y[i] = q0[i];
    integrator.y[numbers + i] = qd0[i];
    absolute[i] = absolute[numbers + i] = atol;
  }
  for (int change = 0; change < result.count; ++change) {
    for (int i = 0; i < n; ++i) {
      integrator.y[(change + 1) * n + i] = basis[change * 2 * n + i];
      integrator.y[numbers + (change + 1) * n + i] = basis[change * 2 * n + n + i];
    }
  }
  stepper.set_tolerances(relative.data(), absolute.data());

  GrowthRecorder recorder(stepper, n, times, result);
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
