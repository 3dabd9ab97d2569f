// Sine and cosine of a pack of angles, beside the C library's.
// latency: each angle waits for the sine of the angle before. throughput: no angle waits.
#include "arithmetic/sine_cosine.hpp"
#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

#include "calls.hpp"

namespace {

using namespace pendcore;
constexpr int angles = 512;

template <class Real>
PENDCORE_INLINE void chain(double* angle) {
  Real x = load<Real>(angle), s, c;
  for (int i = 0; i < angles; ++i) {
    sine_cosine(x, s, c);
    x = fma(1e-3, s, x);
  }
  store(angle, x);
}

template <class Real>
PENDCORE_INLINE void apart(const double* angle, double* sums) {
  for (int i = 0; i < angles; i += Lanes<Real>::width) {
    Real s, c;
    sine_cosine(load<Real>(angle + i), s, c);
    store(sums + i, Real(s + c));
  }
}

void c_library(const double* angle, double* sums) {
  for (int i = 0; i < angles; ++i) sums[i] = std::sin(angle[i]) + std::cos(angle[i]);
}

/// As runs compile kernels on packs of this width.
template <class Real>
constexpr Sets sets_of = Lanes<Real>::width >= 4 ? wide_sets : usual_sets;

template <class Real>
void latency(benchmark::State& state) {
  const auto kernel = fastest<&chain<Real>, sets_of<Real>>();
  std::vector<double> angle(8, 1.0);
  for (auto _ : state) kernel(angle.data());
  benchmark::DoNotOptimize(angle.data());
  set_calls(state, angles);
}

void stream(benchmark::State& state, void (*kernel)(const double*, double*)) {
  std::vector<double> angle(angles), sums(angles);
  for (int i = 0; i < angles; ++i) angle[static_cast<std::size_t>(i)] = 0.1 * i - 20.0;
  for (auto _ : state) {
    kernel(angle.data(), sums.data());
    benchmark::DoNotOptimize(sums.data());
    benchmark::ClobberMemory();
  }
  set_calls(state, angles);
}

template <class Real>
void throughput(benchmark::State& state) {
  stream(state, fastest<&apart<Real>, sets_of<Real>>());
}

void throughput_c_library(benchmark::State& state) { stream(state, c_library); }

BENCHMARK(latency<Pack<2>>)->Name("sine_cosine/latency, pack of 2");
BENCHMARK(throughput<double>)->Name("sine_cosine/throughput, one by one");
BENCHMARK(throughput<Pack<2>>)->Name("sine_cosine/throughput, pack of 2");
BENCHMARK(throughput<Pack<4>>)->Name("sine_cosine/throughput, pack of 4");
BENCHMARK(throughput<Pack<8>>)->Name("sine_cosine/throughput, pack of 8");
BENCHMARK(throughput_c_library)->Name("sine_cosine/throughput, C library");

}  // namespace
