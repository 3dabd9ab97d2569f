#include "pendcore/ensemble/ensemble.hpp"

#include <algorithm>
#include <mutex>
#include <new>
#include <stdexcept>
#include <utility>

#include "pendcore/ensemble/workers.hpp"
#include "pendcore/scene/parameters.hpp"
#include "pendcore/simulate/method_choice.hpp"

namespace pendcore {
namespace {

/// Members that a worker takes at once: some milliseconds of work, and for a small ensemble no more
/// than leaves something for everyone.
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
        q0_(scene.links.size()),
        qd0_(scene.links.size()),
        values_(choice.size()) {}

  const Statistics& statistics() const { return statistics_; }

  /// Runs member i, and returns whether it came to its own end. If `goes_on` returns false, the
  /// member is given up and not kept.
  bool run(std::size_t i, const std::function<bool()>& goes_on) {
    members_.read(i, q0_.data(), qd0_.data(), values_.data());
    Options options = options_;
    options.monitor = [&](double) { return goes_on(); };
    try {
      if (choice_.size() == 0) {
        keep(i, simulate(scene_, q0_, qd0_, t0_, t_end_, std::move(options)));
      } else {
        Scene varied = scene_;
        choice_.set(varied, values_);
        keep(i, simulate(varied, q0_, qd0_, t0_, t_end_, std::move(options)));
      }
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::invalid_argument&) {
      results_.status[i] = code(MemberStatus::refused);
    }
    return results_.status[i] != code(MemberStatus::not_run);
  }

 private:
  void keep(std::size_t i, const Solution& solution) {
    if (solution.status == Status::interrupted) return;
    const std::size_t row = 2 * scene_.links.size();
    const std::size_t size = results_.states.size() / members_.count;
    double* to = results_.states.data() + i * size;
    const auto columns = static_cast<std::size_t>(solution.dimension);
    for (std::size_t k = 0; k < solution.t.size(); ++k, to += row) {
      std::copy_n(solution.states.data() + k * columns, row, to);
    }
    results_.t[i] = solution.t_reached;
    const std::size_t events = options_.events.size();
    if (!results_.first_found.empty()) {
      double* const first = results_.first_found.data() + i * events;
      for (auto one = solution.found.rbegin(); one != solution.found.rend(); ++one) {
        first[one->event] = one->t;
      }
    }
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
  std::vector<double> q0_, qd0_, values_;
};

}  // namespace

std::vector<std::string_view> member_status_names() {
  std::vector<std::string_view> names;
  for (const StatusText& one : status_texts) names.push_back(one.name);
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
  EnsembleEnding ending;
  if (members.count == 0) return ending;
  const int workers = number_of_workers(limits, members.count);
  SharedWork work(members.count, chunk_for(members.count, workers), limits);
  std::mutex mutex;
  work.run(workers, [&](bool on_calling_thread) {
    OneByOne one_by_one(scene, members, choice, t0, t_end, options, results);
    const auto goes_on = [&] { return work.goes_on(on_calling_thread); };
    for (Chunk chunk = work.take(); !chunk.is_empty(); chunk = work.take()) {
      for (std::size_t i = chunk.begin; i < chunk.end && goes_on(); ++i) {
        if (one_by_one.run(i, goes_on)) work.count(1);
      }
    }
    const std::scoped_lock lock(mutex);
    add(ending.statistics, one_by_one.statistics());
  });
  ending.status = work.status();
  ending.done = work.done();
  return ending;
}

}  // namespace pendcore
