// One step of dopri5 on the textbook case: six right-hand sides, the new state, its error norm.
// latency: each step starts where the last one ended. again: the same step, never accepted.
#include <benchmark/benchmark.h>
#include <memory>
#include <pendcore/simulate.hpp>
#include <vector>

namespace {

constexpr double h = 0.01;

std::unique_ptr<pendcore::Stepper> stepper() {
  const std::vector<double> y{0.785, 1.047, 0.0, 0.0}, tolerance(4, 1e-9);
  std::vector<double> dydt(4);
  auto made = pendcore::make_stepper(pendcore::Scene::textbook(), "dopri5");
  made->set_tolerances(tolerance.data(), tolerance.data());
  made->evaluate(0.0, y.data(), dydt.data());
  made->start(y.data(), dydt.data());
  return made;
}

void latency(benchmark::State& state) {
  const auto made = stepper();
  double t = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(made->attempt(t, h, 0.0));
    made->accept(t += h);
  }
}

void again(benchmark::State& state) {
  const auto made = stepper();
  for (auto _ : state) benchmark::DoNotOptimize(made->attempt(0.0, h, 0.0));
}

BENCHMARK(latency)->Name("step/latency");
BENCHMARK(again)->Name("step/again");

}  // namespace
