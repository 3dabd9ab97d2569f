// The Taylor series of the textbook's double pendulum alone, by order, which shows the cost of one
// more order. Each series can only begin when the one before has ended, as in steps.
#include <benchmark/benchmark.h>

#include <variant>
#include "arithmetic/instruction_set.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/series/double_pendulum_series.hpp"

namespace {

using namespace pendcore;
using Series = DoublePendulumSeries<NoTorque>;

PENDCORE_INLINE void expand(const Series* series, double* y, int order, double* rows) {
  constexpr double sigma = 0.0625;
  constexpr double nothing = 1e-150;
  series->expand(0.0, y, sigma, order, rows);
  store(y, Pairs(load<Pairs>(y) + nothing * load<Pairs>(rows + 4 * order)));
}

void by_order(benchmark::State& state) {
  const EquationsOfMotion equations = equations_of_motion(Scene::textbook());
  const auto& bare = std::get<DoublePendulum>(equations.form);
  const Series series({bare.weight, bare.coupling, Pair{}, bare.product, bare.delta, 0.0}, {});
  alignas(64) double y[4] = {0.785, 1.047, 1.0, 2.0};
  alignas(64) double rows[4 * (highest_order + 1)] = {};
  const int order = static_cast<int>(state.range(0));
  void (*const kernel)(const Series*, double*, int, double*) = fastest<&expand, Series::sets>();
  for (auto _ : state) kernel(&series, y, order, rows);
  benchmark::DoNotOptimize(rows[4]);
}

BENCHMARK(by_order)->Name("series")->DenseRange(8, 28, 4)->ArgName("order");

}  // namespace
