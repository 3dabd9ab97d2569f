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

/// Members that a worker takes at once: some milliseconds of work, and in a small ensemble few
/// enough that every worker gets some.
constexpr std::size_t usual_chunk = 256;
std::size_t chunk_for(std::size_t count, int workers) {
  return std::clamp<std::size_t>(count / (8 * static_cast<std::size_t>(workers)), 1, usual_chunk);
}

void add(Statistics& sum, const Statistics& one) {
  sum.nfev += one.nfev;
  sum.njev += one.njev;
  sum.nlu += one.nlu;
  sum.accepted += one.accepted;
  sum.rejected += one.rejected;
}

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
    if (!results.extremes.empty()) extremes_.emplace(scene.links.size());
    if (!results.energy_drift.empty()) drift_.emplace(scene);
    if (!results.sensitivities.empty()) {
      check(scene);  // differences by a number that is not finite have no step
      sensitivities_.emplace(scene, results.sensitivity_names);
      sensitivities_->keep(Store::end, options);
    }
  }
  bool asks_for_dense_output() const override { return extremes_ || sensitivities_; }
  void starts(double t, std::span<const double> y) override {
    if (extremes_) extremes_->starts(t, y);
    if (drift_) drift_->starts(t, y);
    if (sensitivities_) sensitivities_->starts(t, y);
  }
  void steps(const WatchedStep& step) override {
    if (extremes_) extremes_->steps(step);
    if (drift_) drift_->steps(step);
    if (sensitivities_) sensitivities_->steps(step);
  }
  void jumps(double t, std::span<const double> y) override {
    if (extremes_) extremes_->jumps(t, y);
    if (drift_) drift_->jumps(t, y);
  }
  void changes(const WatchedChange& change) override {
    if (sensitivities_) sensitivities_->changes(change);
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

/// Runs members one by one, each as simulate() does.
class OneByOne {
 public:
  OneByOne(const Scene& scene, const Members& members, const ParameterChoice& choice, double t0,
           double t_end, const Options& options, const MemberResults& results)
      : scene_(scene),
        members_(members),
        choice_(choice),
        t0_(t0),
        t_end_(t_end),
        options_(options),
        results_(results),
        values_(choice.size()) {}

  const Statistics& statistics() const { return statistics_; }
  const Options& options() const { return options_; }

  /// Reads member i, and returns its scene, which is valid until the next call.
  const Scene& read(std::size_t i, std::vector<double>& state) {
    const std::size_t n = scene_.links.size();
    state.resize(2 * n);
    members_.read(i, state.data(), state.data() + n, values_.data());
    if (choice_.size() == 0) return scene_;
    varied_ = scene_;
    choice_.set(varied_, values_);
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
    Options options = options_;
    options.monitor = monitor;
    try {
      RunReducers reducers(scene, options_, results_);
      if (are_watched(results_)) options.watch = &reducers;
      const Solution solution = simulate(scene, q0, qd0, t0_, t_end_, std::move(options));
      if (solution.status == Status::interrupted) return false;
      if (!results_.largest_exponent.empty() && solution.t_reached != t0_) {
        LyapunovOptions of_exponent = options_of_exponent(options_);
        of_exponent.monitor = monitor;
        const TangentGrowth found = lyapunov(scene, q0, qd0, t0_, solution.t_reached, of_exponent);
        if (found.status == Status::interrupted) return false;
        if (text(found.status).success) {
          results_.largest_exponent[i] = found.growth.back() / std::abs(found.t_reached - t0_);
        }
      }
      keep(i, solution);
      reducers.keep(results_, i);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::invalid_argument&) {
      results_.status[i] = code(MemberStatus::refused);
    }
    return true;
  }

 private:
  void keep(std::size_t i, const Solution& solution) {
    const std::size_t row = 2 * scene_.links.size();
    const std::size_t size = results_.states.size() / members_.count;
    double* to = results_.states.data() + i * size;
    const auto columns = static_cast<std::size_t>(solution.dimension);
    for (std::size_t k = 0; k < solution.t.size(); ++k, to += row) {
      std::copy_n(solution.states.data() + k * columns, row, to);
    }
    results_.t[i] = solution.t_reached;
    keep_first(results_, solution.found, i);
    add(statistics_, solution.statistics);
    results_.status[i] = code(solution.status);
  }

  const Scene& scene_;
  const Members& members_;
  const ParameterChoice& choice_;
  double t0_, t_end_;
  const Options& options_;
  const MemberResults& results_;
  Statistics statistics_;
  std::vector<double> state_, values_;
  Scene varied_;
};

/// The members that a worker takes, for lanes.
class MembersOfWorker final : public LaneSource {
 public:
  MembersOfWorker(SharedWork& work, bool on_calling_thread, OneByOne& one_by_one,
                  const MemberResults& results, bool keeps_times)
      : work_(work),
        on_calling_thread_(on_calling_thread),
        one_by_one_(one_by_one),
        results_(results),
        keeps_times_(keeps_times) {}

  const Scene* next(LaneMember& member) override {
    if (chunk_.is_empty()) chunk_ = work_.take();
    if (chunk_.is_empty()) return nullptr;
    member.number = chunk_.begin++;
    return &one_by_one_.read(member.number, member.state);
  }
  std::unique_ptr<StepWatch> watch(const Scene& scene) override {
    return watches() ? std::make_unique<RunReducers>(scene, one_by_one_.options(), results_)
                     : nullptr;
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
    std::ranges::copy(keeps_times_ ? member.recorded.states : member.state,
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
  SharedWork& work_;
  bool on_calling_thread_;
  OneByOne& one_by_one_;
  const MemberResults& results_;
  bool keeps_times_;
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
  const int workers = number_of_workers(limits, members.count);
  SharedWork work(members.count, chunk_for(members.count, workers), limits);
  std::mutex mutex;
  work.run(workers, [&](bool on_calling_thread) {
    const FloatingPointEnvironment ieee;
    OneByOne one_by_one(scene, members, choice, t0, t_end, own, results);
    MembersOfWorker members_of_worker(work, on_calling_thread, one_by_one, results,
                                      own.store == Store::times);
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
