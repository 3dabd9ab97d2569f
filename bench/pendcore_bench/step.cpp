// One step on the textbook's case. For dopri5: six right-hand sides, the new state, its error norm.
// For taylor, at tolerances 10^-digits: the new state and the series from there.
// Each step starts where the step before ended.
#include <benchmark/benchmark.h>

#include <cmath>
#include <pendcore/simulate.hpp>

#include "calls.hpp"

namespace {

constexpr double h = 0.01;

auto stepper(const char* method, int digits) {
  const std::vector<double> y{0.785, 1.047, 0.0, 0.0};
  return begun(pendcore::Scene::textbook(), method, y, std::pow(10.0, -digits));
}

void latency(benchmark::State& state, const char* method) {
  const auto made = stepper(method, static_cast<int>(state.range(0)));
  double t = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(made->attempt({t}, h, 0.0));
    made->accept(t += h);
  }
}

BENCHMARK_CAPTURE(latency, dopri5, "dopri5")
    ->Name("step/latency/dopri5")
    ->Arg(9)
    ->ArgName("digits");
BENCHMARK_CAPTURE(latency, taylor, "taylor")
    ->Name("step/latency/taylor")
    ->DenseRange(3, 12, 3)
    ->ArgName("digits");

}  // namespace
