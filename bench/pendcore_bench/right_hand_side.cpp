// The right-hand side of the textbook's double pendulum.
// latency: each call waits for the accelerations of the call before, as the stages of a step do.
// throughput: calls on states that do not depend on each other.
#include <benchmark/benchmark.h>
#include <vector>
#include "dynamics/closed_form/double_pendulum.hpp"

#include "calls.hpp"

namespace {

using namespace pendcore;
constexpr int calls = 256;

PENDCORE_INLINE void chain(const DoublePendulum* pendulum, Pair* q, Pair* qd) {
  for (int i = 0; i < calls; ++i) {
    const Pair qdd = pendulum->accelerations(*q, *qd);
    *q = fma(1e-6, qdd, *q);
  }
}

PENDCORE_INLINE void apart(const DoublePendulum* pendulum, const Pair* q, Pair* qdd) {
  for (int i = 0; i < calls; ++i) qdd[i] = pendulum->accelerations(q[i], q[i]);
}

DoublePendulum textbook() {
  const Scene scene = Scene::textbook();
  return {scene, Inertia(scene)};
}

void latency(benchmark::State& state) {
  const DoublePendulum pendulum = textbook();
  const auto kernel = fastest<&chain>();
  Pair q{0.785, 1.047}, qd{0.3, -0.2};
  for (auto _ : state) kernel(&pendulum, &q, &qd);
  benchmark::DoNotOptimize(q);
  set_calls(state, calls);
}

void throughput(benchmark::State& state) {
  const DoublePendulum pendulum = textbook();
  const auto kernel = fastest<&apart>();
  std::vector<Pair> q(calls), qdd(calls);
  for (int i = 0; i < calls; ++i) q[static_cast<std::size_t>(i)] = Pair{0.01 * i, 1.0 - 0.02 * i};
  for (auto _ : state) {
    kernel(&pendulum, q.data(), qdd.data());
    benchmark::DoNotOptimize(qdd.data());
    benchmark::ClobberMemory();
  }
  set_calls(state, calls);
}

BENCHMARK(latency)->Name("right_hand_side/latency");
BENCHMARK(throughput)->Name("right_hand_side/throughput");

}  // namespace
