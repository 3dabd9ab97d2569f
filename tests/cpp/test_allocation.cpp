// No step allocates: a long run asks for memory as often as a short one.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "pendcore/pendcore.hpp"

namespace {
std::atomic<long long> allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace pendcore;

TEST_CASE("the number of allocations does not depend on the number of steps") {
  auto count = [](Store store, double t_end) {
    Options options;
    options.store = store;
    if (store == Store::times) options.t_eval = {0.5 * t_end, t_end};
    const long long before = allocations;
    const Solution solution =
        simulate(Scene::textbook(), {0.7, 1.0}, {0.0, 0.0}, 0.0, t_end, options);
    CHECK(solution.statistics.accepted > 10);
    return allocations - before;
  };
  for (const Store store : {Store::end, Store::times}) {
    const long long few = count(store, 0.2);
    CHECK(few > 0);
    CHECK(count(store, 200.0) == few);
  }
}
