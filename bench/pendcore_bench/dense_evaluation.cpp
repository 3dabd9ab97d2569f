// The dense output of the textbook's case at 10 000 times, in order and in no order.
#include <benchmark/benchmark.h>
#include <algorithm>
#include <pendcore/simulate.hpp>
#include <random>
#include <vector>

#include "calls.hpp"

namespace {

using namespace pendcore;

void evaluate(benchmark::State& state, bool in_order) {
  const Solution solution = simulate(Scene::textbook(), {0.785, 1.047}, {0.0, 0.0}, 0.0, 5.0);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> anywhere(0.0, 5.0);
  std::vector<double> times(10'000);
  std::ranges::generate(times, [&] { return anywhere(random); });
  if (in_order) std::ranges::sort(times);
  for (auto _ : state) benchmark::DoNotOptimize(solution.sample(times).data());
  set_calls(state, static_cast<double>(times.size()));
}

BENCHMARK_CAPTURE(evaluate, in_order, true)->Name("dense_evaluation/in_order");
BENCHMARK_CAPTURE(evaluate, in_no_order, false)->Name("dense_evaluation/in_no_order");

}  // namespace
