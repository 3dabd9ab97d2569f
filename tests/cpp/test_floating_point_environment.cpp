// What the host has switched the processor to does not change a run, and is there again after it.
// WebAssembly has no such switches.
#if !defined(__wasm__)
#include <doctest/doctest.h>

#include <cfenv>
#include <limits>

#include "pendcore/pendcore.hpp"
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

using namespace pendcore;

namespace {

/// A run so slow that squares of its rates are below the least normal number.
Solution tiny_run() {
  Options options;
  options.method = "dopri5";
  const Scene afloat{.links = Scene::textbook().links, .gravity = 0.0};
  return simulate(afloat, {0.3, 0.9}, {3e-160, -1e-160}, 0, 1e159, options);
}

void check_that_it_is_the_same(const Solution& plain, const Solution& other) {
  CHECK(plain.t == other.t);
  CHECK(plain.states == other.states);
  CHECK(plain.dense.coefficients == other.dense.coefficients);
}

/// Half of the least normal number, computed while running: 0 where such numbers are flushed.
double half_of_least() {
  volatile double least = std::numeric_limits<double>::min();
  return 0.5 * least;
}

#if defined(__x86_64__)
unsigned long flush_to_zero() {
  const unsigned found = _mm_getcsr();
  constexpr unsigned flushed = 0x8000;           // results
  constexpr unsigned denormals_are_zero = 0x40;  // operands
  _mm_setcsr(found | flushed | denormals_are_zero);
  return found;
}
void restore(unsigned long found) { _mm_setcsr(static_cast<unsigned>(found)); }
#elif defined(__aarch64__)
unsigned long flush_to_zero() {
  unsigned long found = 0;
  asm volatile("mrs %0, fpcr" : "=r"(found));
  constexpr unsigned long flushed = 1UL << 24;  // FZ, for operands and results
  asm volatile("msr fpcr, %0" : : "r"(found | flushed));
  return found;
}
void restore(unsigned long found) { asm volatile("msr fpcr, %0" : : "r"(found)); }
#endif

}  // namespace

TEST_CASE("another rounding changes no bit of a run, and is there again after it") {
  const Solution plain = tiny_run();
  std::fesetround(FE_UPWARD);
  const Solution other = tiny_run();
  CHECK(std::fegetround() == FE_UPWARD);
  std::fesetround(FE_TONEAREST);
  check_that_it_is_the_same(plain, other);
}

#if defined(__x86_64__) || defined(__aarch64__)
TEST_CASE("flushing small numbers to zero changes no bit of a run, and is there again after it") {
  const Solution plain = tiny_run();
  const unsigned long found = flush_to_zero();
  const Solution other = tiny_run();
  CHECK(half_of_least() == 0.0);
  restore(found);
  CHECK(half_of_least() > 0.0);
  check_that_it_is_the_same(plain, other);
}
#endif
#endif
