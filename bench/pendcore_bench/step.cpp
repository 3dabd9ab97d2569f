// One step on the textbook's case. For dopri5: six right-hand sides, the new state, its error norm.
// For taylor, at tolerances 10^-digits: the new state and the series from there.
// latency: each step starts where the step before ended. again: the same step, never accepted.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <pendcore/simulate.hpp>
#include <vector>
#include "simulate/steppers.hpp"

namespace {

constexpr double h = 0.01;

std::unique_ptr<pendcore::Stepper> stepper(const char* method, int digits) {
  const std::vector<double> y{0.785, 1.047, 0.0, 0.0};
  const std::vector<double> tolerance(4, std::pow(10.0, -digits));
  std::vector<double> dydt(4);
  auto made = pendcore::make_stepper(pendcore::Scene::textbook(), method);
  made->set_tolerances(tolerance.data(), tolerance.data());
  made->evaluate(0.0, y.data(), dydt.data());
  made->start(y.data(), dydt.data());
  return made;
}

void latency(benchmark::State& state, const char* method) {
  const auto made = stepper(method, static_cast<int>(state.range(0)));
  double t = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(made->attempt({t}, h, 0.0));
    made->accept(t += h);
  }
}

void again(benchmark::State& state) {
  const auto made = stepper("dopri5", 9);
  for (auto _ : state) benchmark::DoNotOptimize(made->attempt({0.0}, h, 0.0));
}

BENCHMARK_CAPTURE(latency, dopri5, "dopri5")
    ->Name("step/latency/dopri5")
    ->Arg(9)
    ->ArgName("digits");
BENCHMARK_CAPTURE(latency, taylor, "taylor")
    ->Name("step/latency/taylor")
    ->DenseRange(3, 12, 3)
    ->ArgName("digits");
BENCHMARK(again)->Name("step/again");

}  // namespace
