// What the benchmarks share: the cost of one call, and a stepper that is ready for a step.
#pragma once

#include <benchmark/benchmark.h>
#include <memory>
#include <vector>

#include "simulate/steppers.hpp"

// Counts `calls` in every iteration; the report's column "a call" is the seconds of one.
inline void set_calls(benchmark::State& state, double calls) {
  using benchmark::Counter;
  state.counters["a call"] = Counter(calls, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

inline std::unique_ptr<pendcore::Stepper> begun(const pendcore::Scene& scene, const char* method,
                                                const std::vector<double>& y,
                                                double tolerance = 1e-9) {
  const std::vector<double> tolerances(y.size(), tolerance);
  std::vector<double> rates(y.size());
  auto stepper = pendcore::make_stepper(scene, method);
  stepper->set_tolerances(tolerances.data(), tolerances.data());
  stepper->evaluate(0.0, y.data(), rates.data());
  stepper->start(y.data(), rates.data());
  return stepper;
}
