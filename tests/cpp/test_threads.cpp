// Many threads share scenes and solutions: they simulate, resume, sample and evaluate all at once,
// and each gets the same bits as a thread that is alone. The preset thread-sanitizer also looks for
// races.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <cfenv>
#include <cmath>
#include <thread>

#include "arithmetic/bits.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

constexpr auto own_torque = [](double, std::span<const double>, std::span<const double> qd,
                               std::span<double> Q) { Q[0] -= 0.01 * qd[0]; };
const Link rod = Link::uniform_rod(1.0, 0.7);

/// Scenes with everything that a run keeps for itself: modes, places in tables, locks.
const std::vector<Scene> shared_scenes = {
    Scene::textbook(),
    {.links = {rod}, .effects = {DryJointFriction{.joint = 1, .coulomb = 0.3}}},
    {.links = {rod, rod},
     .effects = {ViscousJoint{.joint = 1, .damping = 0.02},
                 Motor{.joint = 2, .sinusoid = Sinusoid{2.0, 5.0, 0.0}, .limit = 1.5},
                 DryJointFriction{.joint = 2, .coulomb = 0.01},
                 RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.03}}},
    {.links = {rod, rod, rod},
     .effects = {Motor{.joint = 1, .table = Table{{0.0, 0.3, 0.9, 9.0}, {0.0, 1.0, 0.5, 0.5}}},
                 DrivenPivot{.spline = Spline{{0.0, 1.0, 9.0}, {0.0, 0.1, 0.0}, {0.1, 0.0, 0.2}}},
                 CompiledUser::of(own_torque), Lock{.joint = 3}}}};

/// Scenes with modes that change by themselves, and with what the implicit method keeps. Each
/// method runs them.
const std::vector<Scene> scenes_for_every_method = {
    {.links = {rod, rod},
     .effects = {JointStop{.joint = 1, .range = {-0.5, 1.2}, .restitution = 0.7},
                 JointStop{.joint = 2, .range = {-0.4, 0.3}},
                 DryJointFriction{.joint = 2, .coulomb = 0.1, .static_ = 0.2}}},
    {.links = {rod, rod}, .effects = {ViscousJoint{.joint = 2, .damping = 200.0}}}};

/// The shared objects: a scene, and a run of it that stopped half-way.
struct Shared {
  Scene scene;
  Options options;
  Solution begun;

  Shared(const Scene& of, const std::string& method, bool is_ledger_kept) : scene(of) {
    options.method = method;
    options.ledger = options.compensated = is_ledger_kept;
    options.max_step = 0.05;
    if (method != "dopri5") options.rtol = {1e-6};
  }
  Solution run(double t_end) const {
    const std::vector<double> q0(scene.links.size(), 0.7), qd0(scene.links.size(), 0.0);
    return simulate(scene, q0, qd0, 0.0, t_end, options);
  }
};

std::vector<Shared> everything() {
  std::vector<Shared> all;
  for (const bool ledger : {false, true}) {
    for (const Scene& scene : shared_scenes) all.emplace_back(scene, "dopri5", ledger);
    for (const Scene& scene : scenes_for_every_method) {
      for (const char* method : {"dopri5", "radau5", "dopri5-radau5"}) {
        all.emplace_back(scene, method, ledger).options.events = {
            {.function = events::LinkAngle{.link = 2, .value = 1.0}},
            {.function = events::TipLine{.point = {0.5, 0.8}, .normal = {1.0, 0.3}}}};
      }
    }
  }
  for (Shared& shared : all) shared.begun = shared.run(0.8);
  return all;
}

/// Everything that one thread computes from one of them.
std::vector<double> all_of(const Shared& shared) {
  std::vector<double> found;
  const auto keep = [&found](const auto& x) { found.insert(found.end(), x.begin(), x.end()); };
  const Solution whole = shared.run(1.5);
  const Solution longer = resume(shared.scene, shared.begun, 1.5);
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
  keep(shared.begun.sample({0.0, 0.1 * reached, 0.7 * reached, reached}).reshaped());
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
  for (const Shared& shared : all) {
    alone.push_back(all_of(shared));
    CHECK(alone.back().size() > 200);
    CHECK((shared.options.events.empty() || shared.begun.found.size() > 1));
  }
  constexpr int threads = 8;
  std::atomic<int> different = 0;
  std::barrier together(threads);
  {
    std::vector<std::jthread> pool;
    for (std::size_t k = 0; k < threads; ++k) {
      pool.emplace_back([&, k] {
        together.arrive_and_wait();
        for (std::size_t i = 0; i < 2 * all.size(); ++i) {
          const std::size_t mine = (i + k) % all.size();
          if (all_of(all[mine]) != alone[mine]) ++different;
        }
      });
    }
  }
  CHECK(different == 0);
}

namespace {

constexpr std::size_t members = 37;
constexpr std::size_t refused = 5;  // a member that may not be run
const Scene book = Scene::textbook();

std::array<double, 2> start_of(std::size_t i) {
  const double x = static_cast<double>(i);
  if (i == refused) return {std::nan(""), 0.0};
  return {std::fmod(0.37 * x, 6.0) - 3.0, std::fmod(0.73 * x, 6.0) - 3.0};
}
double gravity_of(std::size_t i) { return 9.0 + 0.01 * static_cast<double>(i); }

Options options_of(const std::string& method, double rtol = 1e-9) {
  Options options{.rtol = rtol, .store = Store::end};
  options.method = method;
  return options;
}

struct EnsembleRun {
  std::vector<std::uint8_t> status = std::vector<std::uint8_t>(members);
  std::vector<double> t = std::vector<double>(members);
  std::vector<double> states = std::vector<double>(4 * members);

  EnsembleRun(const Options& options, int workers) {
    const Members all{.count = members,
                      .names = {"gravity"},
                      .read = [](std::size_t i, double* q0, double* qd0, double* gravity) {
                        std::ranges::copy(start_of(i), q0);
                        qd0[0] = qd0[1] = 0.25;
                        *gravity = gravity_of(i);
                      }};
    const EnsembleEnding ending =
        run_ensemble(book, all, 0.0, 2.0, options, {.workers = workers},
                     {.status = status, .t = t, .states = states, .first_found = {}});
    CHECK(ending.status == Status::finished);
    CHECK(ending.done == members);
  }
};

}  // namespace

TEST_CASE("members of an ensemble have the bits of simulate, in lanes and with many workers") {
  for (const char* method : {"dopri5", "dop853", "taylor"}) {
    for (const double rtol : {1e-3, 1e-8}) {
      const Options options = options_of(method, rtol);
      const EnsembleRun one(options, 1), four(options, 4);
      for (std::size_t i = 0; i < members; ++i) {
        const auto first = static_cast<std::ptrdiff_t>(4 * i);
        Scene scene = book;
        scene.gravity = gravity_of(i);
        const Solution alone = i == refused
                                   ? Solution()
                                   : simulate(scene, start_of(i), {0.25, 0.25}, 0.0, 2.0, options);
        for (const EnsembleRun* const run : {&one, &four}) {
          const std::uint8_t status =
              i == refused ? code(MemberStatus::refused) : code(alone.status);
          CHECK(run->status[i] == status);
          CHECK(std::ranges::equal(alone.states,
                                   std::span(run->states).subspan(first, alone.states.size())));
        }
      }
    }
  }
}

TEST_CASE("another rounding changes no bit of an ensemble") {
  for (const char* method : {"dopri5", "taylor"}) {
    const EnsembleRun plain(options_of(method), 3);
    std::fesetround(FE_UPWARD);
    const EnsembleRun other(options_of(method), 3);
    std::fesetround(FE_TONEAREST);
    CHECK(hash_bits(other.states) == hash_bits(plain.states));
  }
}
