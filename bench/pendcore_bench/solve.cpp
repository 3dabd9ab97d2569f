// The textbook's case, 0 to 5 s, at rtol = atol = 10^-digits. It keeps the end only, 101 times, or
// dense output.
// "a call" is a right-hand side, or a series for taylor.
#include <benchmark/benchmark.h>
#include <cmath>
#include <pendcore/simulate.hpp>
#include <vector>

#include "calls.hpp"

namespace {

using namespace pendcore;

void solve(benchmark::State& state, const char* method, Store store) {
  const Scene scene = Scene::textbook();
  const std::vector<double> q0{M_PI / 4, M_PI / 3}, qd0{0.0, 0.0};
  Options options;
  options.method = method;
  options.rtol = options.atol = {std::pow(10.0, -static_cast<double>(state.range(0)))};
  options.store = store;
  for (int i = 0; store == Store::times && i <= 100; ++i) options.t_eval.push_back(0.05 * i);
  Statistics statistics;
  for (auto _ : state) {
    const Solution solution = simulate(scene, q0, qd0, 0.0, 5.0, options);
    benchmark::DoNotOptimize(solution.states.data());
    statistics = solution.statistics;
  }
  state.counters["right-hand sides"] = static_cast<double>(statistics.nfev);
  set_calls(state, static_cast<double>(statistics.nfev));
}

void digits(benchmark::internal::Benchmark* one) { one->DenseRange(3, 12, 3)->ArgName("digits"); }

BENCHMARK_CAPTURE(solve, dopri5_end, "dopri5", Store::end)->Apply(digits);
BENCHMARK_CAPTURE(solve, dopri5_times, "dopri5", Store::times)->Apply(digits);
BENCHMARK_CAPTURE(solve, dopri5_dense, "dopri5", Store::dense)->Apply(digits);
BENCHMARK_CAPTURE(solve, taylor_end, "taylor", Store::end)->Apply(digits);
BENCHMARK_CAPTURE(solve, taylor_times, "taylor", Store::times)->Apply(digits);
BENCHMARK_CAPTURE(solve, taylor_dense, "taylor", Store::dense)->Apply(digits);

}  // namespace
