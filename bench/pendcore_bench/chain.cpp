// The right-hand side of a chain of n links: by itself, and as a sixth of a step of dopri5.
#include <benchmark/benchmark.h>
#include <pendcore/pendcore.hpp>
#include <vector>

#include "calls.hpp"

namespace {

using namespace pendcore;

Scene hanging_chain(int n) {
  Scene scene;
  for (int i = 0; i < n; ++i) scene.links.push_back(Link::uniform_rod(1.0 + 0.01 * (i % 7), 1.0));
  return scene;
}

std::vector<double> angles(int n) {
  std::vector<double> q(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) q[static_cast<std::size_t>(i)] = 1.5 + 0.1 * (i % 5);
  return q;
}

void right_hand_side(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const EquationsOfMotion equations = equations_of_motion(hanging_chain(n));
  const std::vector<double> q = angles(n), qd(q.size(), 0.3);
  std::vector<double> qdd(q.size());
  for (auto _ : state) {
    accelerations(equations, 0.0, q.data(), qd.data(), qdd.data());
    benchmark::DoNotOptimize(qdd.data());
    benchmark::ClobberMemory();
  }
  state.SetComplexityN(n);
  set_calls(state, n);
}

void step(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  std::vector<double> y = angles(n);
  y.resize(2 * y.size(), 0.3);
  const auto stepper = begun(hanging_chain(n), "dopri5", y);
  for (auto _ : state) benchmark::DoNotOptimize(stepper->attempt({0.0}, 1e-3, 0.0));
  set_calls(state, 6.0 * n);
}

// The column "a call" is the time for one link.
void lengths(benchmark::internal::Benchmark* benchmark) {
  for (const int n : {2, 3, 10, 100, 1000, 10000}) benchmark->Arg(n);
  benchmark->ArgName("links");
}
BENCHMARK(right_hand_side)->Name("chain/right_hand_side")->Apply(lengths)->Complexity();
BENCHMARK(step)->Name("chain/step")->Apply(lengths);

}  // namespace
