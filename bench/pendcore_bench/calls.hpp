// The cost of one call in a benchmark that makes many calls at a time.
#pragma once

#include <benchmark/benchmark.h>

// Counts `calls` in every iteration; the report's column "a call" is the seconds of one.
inline void set_calls(benchmark::State& state, double calls) {
  using benchmark::Counter;
  state.counters["a call"] = Counter(calls, Counter::kIsIterationInvariantRate | Counter::kInvert);
}
