#include "pendcore/simulate.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "arithmetic/floating_point_environment.hpp"
#include "dynamics/energetics/ledger.hpp"
#include "integrate/loop/first_step.hpp"
#include "integrate/loop/integrate.hpp"
#include "integrate/loop/interruption.hpp"
#include "integrate/loop/run_limits.hpp"
#include "pendcore/solution.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/ending_message.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/kinks_of_run.hpp"
#include "simulate/method_choice.hpp"
#include "simulate/recorder.hpp"
#include "simulate/steppers.hpp"
#include "simulate/switching.hpp"

namespace pendcore {
namespace {

/// Whether a run has come further than its start. One that has not begins anew.
bool has_begun(const IntegratorState& state) { return state.h != 0.0; }

/// A run of a scene, from its start or from where another one ended, into a solution.
class SceneRun {
 public:
  SceneRun(const Scene& scene, Solution& solution, IntegratorState&& start, Limits&& limits,
           const std::vector<long long>& passed_events)
      : scene_(scene),
        solution_(solution),
        options_(solution.options),
        limits_(std::move(limits)),
        state_(std::move(start)),
        resumable_(state_),
        equations_(equations_of_motion(scene)),
        rtol_(relative_tolerances(options_, scene.links.size())),
        atol_(absolute_tolerances(options_, scene.links.size())),
        stepper_(stepper_with_tolerances()),
        recorder_(solution, *stepper_, scene, passed_events) {
    limits_.first_kink = first_kink_of(scene, equations_, options_, stepper_->dimension());
    const int degree = stepper_->interpolant_degree();
    if (solution.resumable == nullptr) {
      solution.dense.degree = degree;
      recorder_.start(state_.t.high, state_.y);
    } else if (solution.dense.degree != degree) {
      throw std::invalid_argument("the dense output of this solution is not that of its method");
    }
    if (!equations_.held_joints) return;
    switching_.emplace(scene, equations_, solution.accounts, options_.watch);
    if (!stopped_is_caught) return;
    // Deciding which joints are held is not a step, and takes long in a long chain.
    RunLimits& clock = clock_.emplace(limits_, state_.t.high);
    equations_.held_joints->look_up_in_long_work([this, &clock] {
      const Status status = clock.look(state_.t.high);
      if (status != Status::finished) throw Stopped{status};
    });
  }
  SceneRun(const SceneRun&) = delete;  // the clock refers to it
  SceneRun& operator=(const SceneRun&) = delete;

  void go() {
    const Ending ending = has_begun(state_) ? go_on() : begin();
    if (!ending.cut) recorder_.restarts_here();
    complete_solution(ending);
  }

 private:
  std::unique_ptr<Stepper> stepper_with_tolerances() const {
    auto stepper =
        make_stepper(scene_, equations_, options_.method, options_.ledger, options_.compensated);
    stepper->set_tolerances(rtol_.data(), atol_.data());
    return stepper;
  }
  bool is_forward() const { return !(limits_.t_end < state_.t.high); }

  Ending go_on() {
    if (switching_) {
      switching_->restore(state_.discontinuities, state_.t.high, state_.y.data(), is_forward());
    }
    stepper_->start(state_.y.data(), state_.dydt.data());
    stepper_->restore(state_.stepper);
    state_.statistics.nfev += stepper_->evaluations;
    return take_steps();
  }

  /// If a user's function throws at the beginning, or an impact is not finite, nothing of it is
  /// kept, and a continued run begins anew.
  Ending begin() {
    recorder_.restarts_here();
    int bad = -1;
    const Interruption found = interruption_of([&] { bad = choose_first_step(); });
    const Status status = bad >= 0 ? Status::non_finite : found.status;
    if (status != Status::finished) state_ = resumable_;
    state_.statistics.nfev = stepper_->evaluations;
    if (status == Status::finished) return take_steps();
    resumable_ = state_;
    return {.status = status, .cut = true, .bad = bad, .error = found.error};
  }

  /// Chooses the laws, the rates and the first step at the start. Returns the component that is not
  /// finite, or -1.
  int choose_first_step() {
    const double t = state_.t.high;
    std::vector<double>& y = state_.y;
    std::vector<double> before;
    if (switching_) before = y;
    const bool jumped = switching_ && switching_->begin(t, y.data(), is_forward());
    if (const int bad = bad_component(y); bad >= 0) return bad;
    stepper_->evaluate(t, y.data(), state_.dydt.data());
    stepper_->start(y.data(), state_.dydt.data());
    if (t != limits_.t_end) {
      double size = options_.step.value_or(
          std::min(options_.first_step.value_or(options_.max_step), options_.max_step));
      if (!options_.step && !options_.first_step) {
        const FirstStep first =
            first_step(*stepper_, t, limits_.t_end, options_.max_step, rtol_.data(), atol_.data());
        size = first.h;
        limits_.begins_anew = first.is_bounded;
      }
      state_.h = is_forward() ? size : -size;
      state_.h_is_max_step = options_.step || size == options_.max_step;
    }
    if (jumped) {
      recorder_.state_jumped(t, before.data(), y.data());
    } else {
      recorder_.state_settled(t, y.data());
    }
    return -1;
  }

  Ending take_steps() {
    if (switching_) state_.discontinuities = switching_->saved_state();
    return integrate(*stepper_, state_, resumable_, limits_, recorder_,
                     switching_ ? &*switching_ : nullptr);
  }

  void complete_solution(const Ending& ending) {
    solution_.status = ending.status;
    solution_.statistics = state_.statistics;
    solution_.t_reached = state_.t.high;
    solution_.resumable = std::make_shared<const IntegratorState>(std::move(resumable_));
    solution_.message =
        ending_message(ending, scene_, solution_, state_, switching_ ? switching_->remark() : "",
                       recorder_.ended_by());
    if (switching_) solution_.message += switching_->remark_on_impacts();
    solution_.last_method = stepper_->info().name;
    solution_.message += remark_on_steps(scene_, equations_, solution_, state_);
    solution_.error = ending.error;
    solution_.options.watch = nullptr;
    solution_.y_reached = std::move(state_.y);
    if (options_.store == Store::end) {
      solution_.t = {solution_.t_reached};
      solution_.states = solution_.y_reached;
    }
  }

  const Scene& scene_;
  Solution& solution_;
  const Options& options_;
  Limits limits_;
  IntegratorState state_;
  IntegratorState resumable_;
  EquationsOfMotion equations_;
  std::vector<double> rtol_, atol_;
  std::unique_ptr<Stepper> stepper_;
  Recorder recorder_;
  std::optional<Switching> switching_;
  std::optional<RunLimits> clock_;
};

long long attempts(const Statistics& statistics) {
  return statistics.accepted + statistics.rejected;
}

Limits limits_of(const Options& options, double t_end) {
  return {.t_end = t_end,
          .max_step = options.max_step,
          .fixed_step = options.step.has_value(),
          .max_steps = options.max_steps,
          .time_limit = options.time_limit.value_or(std::numeric_limits<double>::infinity()),
          .monitor = options.monitor};
}

}  // namespace

Solution simulate(const Scene& scene, const Numbers& q0, const Numbers& qd0, double t0,
                  double t_end, Options options) {
  const FloatingPointEnvironment ieee;
  const std::size_t n = scene.links.size();
  check(scene);
  check_start(scene, q0.span(), qd0.span(), t0, t_end);
  check_options(scene, options, t0, t_end);

  options.method = chosen_method(scene, options);
  options.store = options.store.value_or(usual_store(options));
  Limits limits = limits_of(options, t_end);
  Solution solution(std::move(options));
  solution.options.monitor = nullptr;
  solution.scene = scene;
  solution.t0 = t0;
  solution.t_end = t_end;
  solution.n = static_cast<int>(n);
  if (solution.options.ledger) solution.accounts = accounts_of(scene);
  const std::size_t dimension = 2 * n + solution.accounts.size();
  solution.dimension = static_cast<int>(dimension);
  IntegratorState start;
  start.t = {t0, 0.0};
  start.y.resize(dimension);
  std::ranges::copy(qd0.span(), std::ranges::copy(q0.span(), start.y.begin()).out);
  solution.start = start.y;
  start.dydt.resize(dimension);
  SceneRun(scene, solution, std::move(start), std::move(limits), {}).go();
  return solution;
}

Solution resume(const Scene& scene, const Solution& solution, double t_end,
                const NumberList& t_eval, long long max_steps, std::optional<double> time_limit,
                const Monitor& monitor) {
  const FloatingPointEnvironment ieee;
  Solution longer = solution;
  Options& options = longer.options;
  check_continuation(scene, solution, t_end, t_eval);
  options.max_steps = max_steps;
  options.time_limit = time_limit;
  options.t_eval.insert(options.t_eval.end(), t_eval.begin(), t_eval.end());
  check(options);

  longer.t_end = t_end;
  const IntegratorState& from = *solution.resumable;
  if (!has_begun(from)) {
    const std::span start(solution.start);
    check_start(scene, start.first(solution.n), start.subspan(solution.n, solution.n), solution.t0,
                t_end);
  }
  std::vector<long long> passed_events(options.events.size());
  for (const FoundEvent& one : longer.found) ++passed_events[one.event];
  const Solution::Kept kept = longer.resumable_kept;
  longer.found.resize(kept.found);
  const auto dimension = static_cast<std::size_t>(longer.dimension);
  const auto degree = static_cast<std::size_t>(longer.dense.degree);
  longer.t.resize(kept.t);
  longer.states.resize(kept.t * dimension);
  longer.dense.start.resize(kept.steps);
  longer.dense.start_low.resize(kept.steps);
  longer.dense.h.resize(kept.steps);
  longer.dense.coefficients.resize(kept.steps * (degree + 1) * dimension);
  Limits limits = limits_of(options, t_end);
  limits.monitor = monitor;
  // If the end is the same, the run repeats what it did since the resumable position. That is not
  // counted as steps of the continuation.
  if (t_end == solution.t_end) {
    const long long again = attempts(solution.statistics) - attempts(from.statistics);
    const long long most = std::numeric_limits<long long>::max() - max_steps;
    limits.max_steps += std::clamp(again, 0LL, most);
  }
  SceneRun(scene, longer, IntegratorState(from), std::move(limits), passed_events).go();
  return longer;
}

}  // namespace pendcore
