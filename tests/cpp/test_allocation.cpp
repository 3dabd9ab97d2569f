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

long long count(const Scene& scene, Store store, double t_end, bool ledger, bool compensated) {
  const std::size_t n = scene.links.size();
  Options options;
  options.method = "dopri5";
  options.store = store;
  options.ledger = ledger;
  options.compensated = compensated;
  if (store == Store::times) options.t_eval = {0.5 * t_end, t_end};
  const long long before = allocations;
  const Solution solution = simulate(scene, std::vector<double>(n, 0.7),
                                     std::vector<double>(n, 0.1), 0.0, t_end, options);
  CHECK(solution.statistics.accepted > 10);
  return allocations - before;
}

}  // namespace

TEST_CASE("events that are not found ask for no memory either") {
  const std::vector<Event> events = {
      {.function = events::LinkAngle{.link = 1, .value = 50.0}, .terminal = 1},
      {.function = events::JointAngle{.joint = 2, .value = -50.0}},
      {.function = events::TipLine{.point = {0.0, 2.5}, .normal = {0.3, 1.0}}},
      {.function = events::Function{.f = [](double, std::span<const double> q,
                                            auto) { return q[0] + 50.0; }}},
  };
  const std::vector<Link> links(3, Link::uniform_rod(1.0, 0.7));
  const auto count_to = [&](double t_end) {
    Options options;
    options.method = "dopri5";
    options.store = Store::end;
    options.events = events;
    const long long before = allocations;
    const Solution solution =
        simulate({.links = links}, {0.7, 0.7, 0.7}, {0.1, 0.1, 0.1}, 0.0, t_end, options);
    CHECK(solution.status == Status::finished);
    return allocations - before;
  };
  CHECK(count_to(20.0) == count_to(2.0));
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
    const std::vector<Link> links(n, Link::uniform_rod(1.0, 1.0));
    scenes.push_back({.links = links});
    scenes.push_back({.links = links, .effects = effects});
    if (n > 1) scenes.push_back({.links = links, .effects = {Lock{.joint = 2, .angle = 0.0}}});
  }
  for (const Scene& scene : scenes) {
    for (const Store store : {Store::end, Store::times}) {
      for (const bool ledger : {false, true}) {
        for (const bool compensated : {false, true}) {
          // After a thousand steps of a scene with effects, the message at the end looks for a fast
          // mode.
          const double t_end = scene.effects.empty() ? 0.5 : 60.0;
          const long long few = count(scene, store, t_end, ledger, compensated);
          CHECK(few > 0);
          CHECK(count(scene, store, 100.0, ledger, compensated) == few);
        }
      }
    }
  }
}

TEST_CASE("a run that solves for no joint takes memory in proportion to its links") {
  const auto asked_for = [](std::size_t n, const std::vector<Effect>& effects,
                            const std::string& method) {
    const Scene scene{.links = std::vector<Link>(n, Link::uniform_rod(1.0, 1.0)),
                      .effects = effects};
    Options options;
    options.store = Store::end;
    options.method = method;
    options.max_steps = 12;
    const long long before = bytes;
    const Solution solution = simulate(scene, std::vector<double>(n, 0.7),
                                       std::vector<double>(n, 0.1), 0.0, 1.0, options);
    CHECK(solution.statistics.accepted > 0);
    CHECK(solution.statistics.njev == 0);
    return bytes - before;
  };
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
      CHECK(2 * asked_for(800, effects, method) < 5 * asked_for(400, effects, method));
    }
  }
}
