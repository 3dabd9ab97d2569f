#include "pendcore/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <ranges>
#include <stdexcept>
#include <utility>

#include "analysis/sensitivities.hpp"
#include "arithmetic/floating_point_environment.hpp"
#include "ensemble/lanes.hpp"
#include "ensemble/reducers.hpp"
#include "ensemble/workers.hpp"
#include "pendcore/lyapunov.hpp"
#include "pendcore/parameters.hpp"
#include "pendcore/simulate.hpp"
#include "pendcore/solution.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/method_choice.hpp"
#include "simulate/steppers.hpp"

namespace pendcore {
namespace {

/// Keeps the time of the first of each event that member i found, if that is wanted.
void keep_first(const MemberResults& results, const std::vector<FoundEvent>& found, std::size_t i) {
  if (results.first_found.empty()) return;
  const std::size_t events = results.first_found.size() / results.status.size();
  double* const first = results.first_found.data() + i * events;
  for (const FoundEvent& one : found | std::views::reverse) first[one.event] = one.t;
}

/// Whether a reducer looks on while a run is made.
bool are_watched(const MemberResults& results) {
  return !results.extremes.empty() || !results.energy_drift.empty() ||
         !results.sensitivities.empty();
}

/// Computes reducers of one run while it is made.
class RunReducers final : public StepWatch {
 public:
  RunReducers(const Scene& scene, const Options& options, const MemberResults& results) {
    if (!results.extremes.empty()) wanted_.push_back(&extremes_.emplace(scene.links.size()));
    if (!results.energy_drift.empty()) wanted_.push_back(&drift_.emplace(scene));
    if (!results.sensitivities.empty()) {
      check(scene);  // differences by a number that is not finite have no step
      wanted_.push_back(&sensitivities_.emplace(scene, results.sensitivity_names));
      sensitivities_->keep(Store::end, options);
    }
  }
  RunReducers(const RunReducers&) = delete;  // it points to its own reducers
  RunReducers& operator=(const RunReducers&) = delete;

  bool asks_for_dense_output() const override {
    return std::ranges::any_of(wanted_, &StepWatch::asks_for_dense_output);
  }
  void starts(double t, std::span<const double> y) override {
    for (StepWatch* const one : wanted_) one->starts(t, y);
  }
  void steps(const WatchedStep& step) override {
    for (StepWatch* const one : wanted_) one->steps(step);
  }
  void jumps(double t, std::span<const double> y) override {
    for (StepWatch* const one : wanted_) one->jumps(t, y);
  }
  void changes(const WatchedChange& change) override {
    for (StepWatch* const one : wanted_) one->changes(change);
  }
  /// Keeps what was found of member i, whose status is known.
  void keep(const MemberResults& results, std::size_t i) const {
    const std::size_t size = results.extremes.size() / results.status.size();
    if (extremes_) extremes_->write(results.extremes.data() + i * size);
    if (drift_) results.energy_drift[i] = drift_->largest();
    if (sensitivities_ && is_success(results.status[i])) {
      const std::vector<double>& found = sensitivities_->values();
      std::ranges::copy(found, results.sensitivities.data() + i * found.size());
    }
  }

 private:
  std::optional<Extremes> extremes_;
  std::optional<EnergyDrift> drift_;
  std::optional<Sensitivities> sensitivities_;
  std::vector<StepWatch*> wanted_;
};

/// The options with which members are run, for what is wanted of them.
Options options_of_members(const Scene& scene, const Options& options,
                           const MemberResults& results) {
  Options own = options;
  if (!results.energy_drift.empty() && !accounts_of(scene).empty()) own.ledger = true;
  return own;
}

LyapunovOptions options_of_exponent(const Options& options) {
  return {.count = 1,
          .rtol = options.rtol.front(),
          .atol = options.atol.front(),
          .t_eval = {},
          .max_step = options.max_step,
          .max_steps = options.max_steps,
          .monitor = {}};
}

/// What all members have in common.
struct EnsembleTask {
  const Scene& scene;
  const Members& members;
  const ParameterChoice& choice;
  double t0, t_end;
  const Options& options;
  const MemberResults& results;
};

/// Runs members one by one, each as simulate() does.
class OneByOne {
 public:
  explicit OneByOne(const EnsembleTask& task) : task_(task), values_(task.choice.size()) {}

  const Statistics& statistics() const { return statistics_; }

  /// Reads member i, and returns its scene, which is valid until the next call.
  const Scene& read(std::size_t i, std::vector<double>& state) {
    const std::size_t n = task_.scene.links.size();
    state.resize(2 * n);
    task_.members.read(i, state.data(), state.data() + n, values_.data());
    if (task_.choice.size() == 0) return task_.scene;
    varied_ = task_.scene;
    task_.choice.set(varied_, values_);
    return varied_;
  }

  /// Runs member i, and returns whether it came to its own end. If `goes_on` returns false, the
  /// member is given up and not kept.
  bool run(std::size_t i, const std::function<bool()>& goes_on) {
    const Scene& scene = read(i, state_);
    const auto middle = state_.begin() + static_cast<std::ptrdiff_t>(scene.links.size());
    const std::vector<double> q0{state_.begin(), middle};
    const std::vector<double> qd0{middle, state_.end()};
    const Monitor monitor = [&](double) { return goes_on(); };
    const MemberResults& results = task_.results;
    Options options = task_.options;
    options.monitor = monitor;
    try {
      RunReducers reducers(scene, task_.options, results);
      if (are_watched(results)) options.watch = &reducers;
      const double t0 = task_.t0;
      const Solution solution = simulate(scene, q0, qd0, t0, task_.t_end, std::move(options));
      if (solution.status == Status::interrupted) return false;
      if (!results.largest_exponent.empty() && solution.t_reached != t0) {
        LyapunovOptions of_exponent = options_of_exponent(task_.options);
        of_exponent.monitor = monitor;
        const TangentGrowth found = lyapunov(scene, q0, qd0, t0, solution.t_reached, of_exponent);
        if (found.status == Status::interrupted) return false;
        if (text(found.status).success) {
          results.largest_exponent[i] = found.growth.back() / std::abs(found.t_reached - t0);
        }
      }
      keep(i, solution);
      reducers.keep(results, i);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::invalid_argument&) {
      results.status[i] = code(MemberStatus::refused);
    }
    return true;
  }

 private:
  void keep(std::size_t i, const Solution& solution) {
    const MemberResults& results = task_.results;
    const std::size_t row = 2 * task_.scene.links.size();
    const std::size_t size = results.states.size() / results.status.size();
    double* to = results.states.data() + i * size;
    const auto columns = static_cast<std::size_t>(solution.dimension);
    for (std::size_t k = 0; k < solution.t.size(); ++k, to += row) {
      std::copy_n(solution.states.data() + k * columns, row, to);
    }
    results.t[i] = solution.t_reached;
    keep_first(results, solution.found, i);
    add(statistics_, solution.statistics);
    results.status[i] = code(solution.status);
  }

  const EnsembleTask& task_;
  Statistics statistics_;
  std::vector<double> state_, values_;
  Scene varied_;
};

/// The members that a worker takes, for lanes.
class MembersOfWorker final : public LaneSource {
 public:
  MembersOfWorker(const EnsembleTask& task, SharedWork& work, bool on_calling_thread,
                  OneByOne& one_by_one)
      : options_(task.options),
        results_(task.results),
        work_(work),
        on_calling_thread_(on_calling_thread),
        one_by_one_(one_by_one) {}

  const Scene* next(LaneMember& member) override {
    if (chunk_.is_empty()) chunk_ = work_.take();
    if (chunk_.is_empty()) return nullptr;
    member.number = chunk_.begin++;
    return &one_by_one_.read(member.number, member.state);
  }
  std::unique_ptr<StepWatch> watch(const Scene& scene) override {
    return watches() ? std::make_unique<RunReducers>(scene, options_, results_) : nullptr;
  }
  bool watches() const override { return are_watched(results_); }
  bool watches_dense_output() const override { return !results_.extremes.empty(); }
  const Scene& scene_of(std::size_t number) override {
    std::vector<double> state;
    return one_by_one_.read(number, state);
  }
  void ended(const LaneMember& member) override {
    results_.t[member.number] = member.t;
    const std::size_t size = results_.states.size() / results_.status.size();
    const bool keeps_times = options_.store == Store::times;
    std::ranges::copy(keeps_times ? member.recorded.states : member.state,
                      results_.states.data() + member.number * size);
    keep_first(results_, member.recorded.found, member.number);
    results_.status[member.number] = code(member.status);
    if (watches()) static_cast<const RunReducers&>(*member.watch).keep(results_, member.number);
    work_.count(1);
  }
  void run_alone(std::size_t number) override {
    if (one_by_one_.run(number, [this] { return goes_on(); })) work_.count(1);
  }
  bool goes_on() override { return work_.goes_on(on_calling_thread_); }

 private:
  const Options& options_;
  const MemberResults& results_;
  SharedWork& work_;
  bool on_calling_thread_;
  OneByOne& one_by_one_;
  Chunk chunk_;
};

}  // namespace

std::vector<std::string_view> member_status_names() {
  std::vector<std::string_view> names(status_texts.size());
  std::ranges::transform(status_texts, names.begin(), &StatusText::name);
  names.insert(names.end(), {"not_run", "refused"});
  return names;
}

EnsembleEnding run_ensemble(const Scene& scene, const Members& members, double t0, double t_end,
                            const Options& options, const EnsembleLimits& limits,
                            const MemberResults& results) {
  const ParameterChoice choice(scene, members.names);
  check_options(scene, options, t0, t_end);
  static_cast<void>(relative_tolerances(options, scene.links.size()));
  static_cast<void>(absolute_tolerances(options, scene.links.size()));
  static_cast<void>(make_stepper(scene, chosen_method(scene, options)));
  const Options own = options_of_members(scene, options, results);
  if (!results.largest_exponent.empty()) check_has_exponents(scene);
  if (!results.sensitivities.empty()) {
    static_cast<void>(Sensitivities(scene, results.sensitivity_names));
  }
  EnsembleEnding ending;
  if (members.count == 0) return ending;
  SharedWork work(members.count, limits);
  const EnsembleTask task{scene, members, choice, t0, t_end, own, results};
  std::mutex mutex;
  work.run([&](bool on_calling_thread) {
    const FloatingPointEnvironment ieee;
    OneByOne one_by_one(task);
    MembersOfWorker members_of_worker(task, work, on_calling_thread, one_by_one);
    // The largest exponent takes a run of its own, and derivatives are found for one at a time.
    const bool in_lanes = results.largest_exponent.empty() && results.sensitivities.empty();
    const std::unique_ptr<LaneRunner> lanes =
        in_lanes ? make_lanes(scene, t0, t_end, own) : nullptr;
    if (lanes) {
      lanes->run(members_of_worker);
    } else {
      LaneMember member;
      while (members_of_worker.goes_on() && members_of_worker.next(member) != nullptr)
        members_of_worker.run_alone(member.number);
    }
    const std::scoped_lock lock(mutex);
    add(ending.statistics, one_by_one.statistics());
    if (lanes) add(ending.statistics, lanes->statistics());
  });
  ending.status = work.status();
  ending.done = work.done();
  return ending;
}

}  // namespace pendcore
