// What one call costs, where a benchmark makes many in one go.
#pragma once

#include <benchmark/benchmark.h>

// Counts `calls` in every iteration; the report's column "a call" is the seconds of one.
inline void set_calls(benchmark::State& state, double calls) {
  using benchmark::Counter;
  state.counters["a call"] = Counter(calls, Counter::kIsIterationInvariantRate | Counter::kInvert);
}
