// Many threads share scenes and solutions: they simulate, resume, sample and evaluate all at once,
// and each gets the same bits as a thread that is alone. The preset thread-sanitizer also looks for
// races.
#include <doctest/doctest.h>

#include <atomic>
#include <barrier>
#include <cfenv>
#include <cmath>
#include <limits>
#include <thread>

#include "arithmetic/bits.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

constexpr auto own_torque = [](double /*t*/, std::span<const double> /*q*/,
                               std::span<const double> qd,
                               std::span<double> Q) { Q[0] -= 0.01 * qd[0]; };

/// Scenes with everything that a run keeps for itself: modes, places in tables, locks.
std::vector<Scene> shared_scenes() {
  const std::vector<Link> links(3, Link::uniform_rod(1.0, 0.7));
  return {
      Scene::textbook(),
      {.links = {links[0]}, .effects = {DryJointFriction{.joint = 1, .coulomb = 0.3}}},
      {.links = {links[0], links[1]},
       .effects = {ViscousJoint{.joint = 1, .damping = 0.02},
                   Motor{.joint = 2, .sinusoid = Sinusoid{2.0, 5.0, 0.0}, .limit = 1.5},
                   DryJointFriction{.joint = 2, .coulomb = 0.01},
                   RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.03}}},
      {.links = links,
       .effects = {Motor{.joint = 1, .table = Table{{0.0, 0.3, 0.9, 9.0}, {0.0, 1.0, 0.5, 0.5}}},
                   DrivenPivot{.spline = Spline{{0.0, 1.0, 9.0}, {0.0, 0.1, 0.0}, {0.1, 0.0, 0.2}}},
                   CompiledUser::of(own_torque), Lock{.joint = 3}}},
  };
}

/// Scenes with modes that change by themselves, and with what the implicit method keeps. Each
/// method runs them.
std::vector<Scene> scenes_for_every_method() {
  const std::vector<Link> links(2, Link::uniform_rod(1.0, 0.7));
  return {
      {.links = links,
       .effects = {JointStop{.joint = 1, .range = {-0.5, 1.2}, .restitution = 0.7},
                   JointStop{.joint = 2, .range = {-0.4, 0.3}},
                   DryJointFriction{.joint = 2, .coulomb = 0.1, .static_ = 0.2}}},
      {.links = links, .effects = {ViscousJoint{.joint = 2, .damping = 200.0}}},
  };
}

Options options_of(const std::string& method, bool ledger) {
  Options options;
  options.method = method;
  options.ledger = ledger;
  options.compensated = ledger;
  options.max_step = 0.05;
  if (method != "dopri5") options.rtol = {1e-6};
  return options;
}

/// The shared objects: a scene, and a run of it that stopped half-way.
struct Shared {
  Scene scene;
  std::vector<double> q0, qd0;
  Options options;
  Solution begun;
};

Solution simulated(const Shared& shared, double t_end) {
  return simulate(shared.scene, shared.q0, shared.qd0, 0.0, t_end, shared.options);
}

Solution resumed(const Shared& shared) {
  return resume(shared.scene, shared.begun, 1.5, {}, 1'000'000,
                std::numeric_limits<double>::infinity(), nullptr);
}

std::vector<Shared> everything() {
  std::vector<Shared> all;
  const auto add = [&all](const Scene& scene, const Options& options) {
    const std::size_t n = scene.links.size();
    all.push_back({scene, std::vector<double>(n, 0.7), std::vector<double>(n, 0.0), options, {}});
    all.back().begun = simulated(all.back(), 0.8);
  };
  for (const bool ledger : {false, true}) {
    for (const Scene& scene : shared_scenes()) add(scene, options_of("dopri5", ledger));
    for (const Scene& scene : scenes_for_every_method()) {
      for (const char* method : {"dopri5", "radau5", "dopri5-radau5"}) {
        Options options = options_of(method, ledger);
        options.events = {{.function = events::LinkAngle{.link = 2, .value = 1.0}},
                          {.function = events::TipLine{.point = {0.5, 0.8}, .normal = {1.0, 0.3}}}};
        add(scene, options);
      }
    }
  }
  return all;
}

/// Everything that one thread computes from one of them.
std::vector<double> all_of(const Shared& shared) {
  std::vector<double> found;
  const auto keep = [&found](const std::vector<double>& x) {
    found.insert(found.end(), x.begin(), x.end());
  };
  const Solution whole = simulated(shared, 1.5);
  const Solution longer = resumed(shared);
  for (const Solution* solution : {&whole, &longer, &shared.begun}) {
    keep(solution->t);
    keep(solution->states);
    keep(solution->dense.coefficients);
    for (const FoundEvent& event : solution->found) {
      found.push_back(event.t);
      keep(event.y);
      keep(event.y_before);
    }
  }
  const double reached = shared.begun.t_reached;
  const Matrix sampled = shared.begun.sample({0.0, 0.1 * reached, 0.7 * reached, reached});
  found.insert(found.end(), sampled.data(), sampled.data() + sampled.size());
  for (std::size_t i = 0; i < whole.t.size(); i += 20) {
    const StateView at = whole[i];
    found.push_back(kinetic_energy(shared.scene, at.t, at.q, at.qd));
    found.push_back(potential_energy(shared.scene, at.t, at.q));
  }
  return found;
}

}  // namespace

TEST_CASE("threads that share scenes and solutions compute what one alone does") {
  const std::vector<Shared> all = everything();
  std::vector<std::vector<double>> alone;
  for (const Shared& shared : all) alone.push_back(all_of(shared));

  constexpr int threads = 8;
  std::atomic<int> different = 0;
  std::barrier together(threads);
  {
    std::vector<std::jthread> pool;
    for (int k = 0; k < threads; ++k) {
      pool.emplace_back([&, k] {
        together.arrive_and_wait();
        for (std::size_t i = 0; i < 2 * all.size(); ++i) {
          const std::size_t mine = (i + static_cast<std::size_t>(k)) % all.size();
          if (all_of(all[mine]) != alone[mine]) ++different;
        }
      });
    }
  }
  CHECK(different == 0);
  int watched = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK(alone[i].size() > 200);
    if (all[i].options.events.empty()) continue;
    CHECK(all[i].begun.found.size() > 1);
    ++watched;
  }
  CHECK(watched == 12);
}

namespace {

constexpr std::size_t members = 37;
constexpr double ensemble_end = 2.0;  // s

/// A start of the textbook's rods; one member may not be run.
std::vector<double> start_of(std::size_t i) {
  const double x = static_cast<double>(i);
  if (i == 5) return {std::nan(""), 0.0};
  return {std::fmod(0.37 * x, 6.0) - 3.0, std::fmod(0.73 * x, 6.0) - 3.0};
}

struct EnsembleRun {
  std::vector<std::uint8_t> status = std::vector<std::uint8_t>(members);
  std::vector<double> t = std::vector<double>(members);
  std::vector<double> states = std::vector<double>(4 * members);
};

EnsembleRun run_of(const Options& options, int workers) {
  // The first call computes it, before any test changes the rounding: the scene is an input.
  static const Scene scene = Scene::textbook();
  EnsembleRun run;
  const Members all{.count = members,
                    .names = {"gravity"},
                    .read = [](std::size_t i, double* q0, double* qd0, double* gravity) {
                      const std::vector<double> start = start_of(i);
                      std::copy(start.begin(), start.end(), q0);
                      qd0[0] = qd0[1] = 0.25;
                      *gravity = 9.0 + 0.01 * static_cast<double>(i);
                    }};
  const EnsembleEnding ending =
      run_ensemble(scene, all, 0.0, ensemble_end, options, {.workers = workers},
                   {.status = run.status, .t = run.t, .states = run.states, .first_found = {}});
  CHECK(ending.status == Status::finished);
  CHECK(ending.done == members);
  return run;
}

}  // namespace

TEST_CASE("members of an ensemble have the bits of simulate, in lanes and with many workers") {
  for (const char* method : {"dopri5", "dop853", "taylor"}) {
    for (const double rtol : {1e-3, 1e-8}) {
      Options options;
      options.method = method;
      options.rtol = {rtol};
      options.store = Store::end;
      for (const int workers : {1, 4}) {
        const EnsembleRun run = run_of(options, workers);
        for (std::size_t i = 0; i < members; ++i) {
          if (i == 5) {
            CHECK(run.status[i] == code(MemberStatus::refused));
            continue;
          }
          Scene scene = Scene::textbook();
          scene.gravity = 9.0 + 0.01 * static_cast<double>(i);
          const Solution alone =
              simulate(scene, start_of(i), {0.25, 0.25}, 0.0, ensemble_end, options);
          CHECK(run.status[i] == code(alone.status));
          CHECK(std::equal(alone.states.begin(), alone.states.end(),
                           run.states.begin() + static_cast<std::ptrdiff_t>(4 * i)));
        }
      }
    }
  }
}

TEST_CASE("another rounding changes no bit of an ensemble") {
  for (const char* method : {"dopri5", "taylor"}) {
    Options options;
    options.method = method;
    options.store = Store::end;
    const EnsembleRun plain = run_of(options, 3);
    std::fesetround(FE_UPWARD);
    const EnsembleRun other = run_of(options, 3);
    std::fesetround(FE_TONEAREST);
    const auto bits = [](const EnsembleRun& run) { return hash_bits(run.states); };
    CHECK(bits(other) == bits(plain));
  }
}
