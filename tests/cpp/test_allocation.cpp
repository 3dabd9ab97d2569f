// No step of an explicit method allocates: a long run asks for memory as often as a short one. And
// no run allocates a matrix that it never needs.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "pendcore/pendcore.hpp"

namespace {
std::atomic<long long> allocations = 0;
std::atomic<long long> bytes = 0;
}  // namespace

// This is not inlined, so that GCC does not see a delete of what malloc returned.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  bytes += static_cast<long long>(size);
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace pendcore;

namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

/// How often a run asked for memory, and for how much.
struct Asked {
  long long times, bytes;
};

Asked asked_for(const Scene& scene, const Options& options, double t_end) {
  const std::size_t n = scene.links.size();
  const std::vector<double> q0(n, 0.7), qd0(n, 0.1);
  const Asked before = {allocations, bytes};
  const Solution solution = simulate(scene, q0, qd0, 0.0, t_end, options);
  CHECK(solution.statistics.accepted > 5);
  CHECK(solution.statistics.njev == 0);
  CHECK(solution.found.empty());
  return {allocations - before.times, bytes - before.bytes};
}

Scene rods(std::size_t n, std::vector<Effect> effects = {}) {
  return {.links = std::vector<Link>(n, Link::uniform_rod(1.0, 0.7)),
          .effects = std::move(effects)};
}

Options kept(Store store) {
  Options options{.store = store};
  options.method = "dopri5";
  return options;
}

}  // namespace

TEST_CASE("events that are not found ask for no memory either") {
  Options options = kept(Store::end);
  options.events = {
      {.function = events::LinkAngle{.link = 1, .value = 50.0}, .terminal = 1},
      {.function = events::JointAngle{.joint = 2, .value = -50.0}},
      {.function = events::TipLine{.point = {0.0, 2.5}, .normal = {0.3, 1.0}}},
      {.function = events::Function{.f = [](double, std::span<const double> q,
                                            auto) { return q[0] + 50.0; }}},
  };
  CHECK(asked_for(rods(3), options, 20.0).times == asked_for(rods(3), options, 2.0).times);
}

// This is skipped under the address sanitizer, where it takes a minute and the count is the same.
TEST_CASE("the number of allocations does not depend on the number of steps" *
          doctest::skip(sanitized)) {
  const std::vector<Effect> effects = {
      ViscousJoint{.joint = 1, .damping = 0.01},
      RodDrag{.link = 1, .drag_coefficient = 1.0, .diameter = 0.01},
      Motor{.joint = 1, .sinusoid = Sinusoid{0.1, 2.0, 0.0}},
      DrivenPivot{.x = Sinusoid{0.1, 2.0, 0.0}},
  };
  std::vector<Scene> scenes;
  for (const std::size_t n : {1, 2, 3, 6}) {
    scenes.insert(scenes.end(), {rods(n), rods(n, effects)});
    if (n > 1) scenes.push_back(rods(n, {Lock{.joint = 2, .angle = 0.0}}));
  }
  for (const Scene& scene : scenes) {
    for (int kind = 0; kind < 8; ++kind) {
      Options options = kept(kind % 2 == 0 ? Store::end : Store::times);
      options.ledger = (kind & 2) != 0;
      options.compensated = (kind & 4) != 0;
      const auto count = [&](double t_end) {
        if (options.store == Store::times) options.t_eval = {0.5 * t_end, t_end};
        return asked_for(scene, options, t_end).times;
      };
      // After a thousand steps of a scene with effects, the message at the end looks for a fast
      // mode.
      const long long few = count(scene.effects.empty() ? 0.5 : 60.0);
      CHECK(few > 0);
      CHECK(count(100.0) == few);
    }
  }
}

TEST_CASE("a run that solves for no joint takes memory in proportion to its links") {
  const std::vector<std::vector<Effect>> every_kind = {
      {},
      {ViscousJoint{.joint = 1, .damping = 0.01}},
      {Lock{.joint = 2, .angle = 0.0}},
      {JointStop{.joint = 1, .range = {-3.0, 3.0}}},    // never reached
      {DryJointFriction{.joint = 1, .coulomb = 0.01}},  // it slides
  };
  for (const std::vector<Effect>& effects : every_kind) {
    for (const std::string method : {"dopri5", "dopri5-radau5", "taylor-radau5"}) {
      CAPTURE(method);
      Options options = kept(Store::end);
      options.method = method;
      options.max_steps = 12;
      const auto needed = [&](int n) { return asked_for(rods(n, effects), options, 1.0).bytes; };
      CHECK(2 * needed(800) < 5 * needed(400));
    }
  }
}
