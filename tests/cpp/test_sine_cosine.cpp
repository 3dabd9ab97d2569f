// Sine and cosine against the 64-bit mantissa of long double, and lane by lane.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "arithmetic/sine_cosine.hpp"

using namespace pendcore;

namespace {

double error_in_ulp(double value, long double exact) {
  int exponent;
  std::frexp(static_cast<double>(exact), &exponent);
  const long double ulp = std::ldexp(1.0L, exponent - 53);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

/// Angles up to `range`: uniformly drawn ones, doubles next to multiples of pi/2, and small ones.
double angle(std::mt19937_64& random, double range, int i) {
  const double x = std::uniform_real_distribution(-range, range)(random);
  if (i % 3 == 1) return std::nearbyint(x * 0.6366197723675814) * 1.5707963267948966;
  if (i % 3 == 2) return x * std::exp2(std::uniform_real_distribution(-60.0, 0.0)(random));
  return x;
}

}  // namespace

TEST_CASE("sine and cosine are within one unit in the last place") {
  static_assert(std::numeric_limits<long double>::digits >= 64);
  std::mt19937_64 random(20240601);
  for (const double range : {0.8, 3.2, 100.0, 1e4, 1e6, 1e8, 1e15, 1e22, 1e300}) {
    CAPTURE(range);
    double worst = 0.0;
    for (int i = 0; i < 100'000; ++i) {
      const double x = angle(random, range, i);
      double s, c;
      sine_cosine(x, s, c);
      worst = std::max({worst, error_in_ulp(s, std::sin(static_cast<long double>(x))),
                        error_in_ulp(c, std::cos(static_cast<long double>(x)))});
    }
    CHECK(worst < 0.85);
    CHECK(worst > 0.5);  // otherwise it is not measured
  }
}

TEST_CASE("every lane of every width has the same bits as the number alone") {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20'000; ++i) {
    Pack<8> x, s8, c8;
    for (int k = 0; k < 8; ++k) x[k] = angle(random, k == 3 ? 1e9 : 1e5, i + k);
    sine_cosine(x, s8, c8);
    for (int k = 0; k < 8; k += 2) {
      Pack<2> s2, c2;
      sine_cosine(Pack<2>{x[k], x[k + 1]}, s2, c2);
      for (int j = 0; j < 2; ++j) {
        double s, c;
        sine_cosine(x[k + j], s, c);
        REQUIRE(std::bit_cast<long long>(s) == std::bit_cast<long long>(s8[k + j]));
        REQUIRE(std::bit_cast<long long>(c) == std::bit_cast<long long>(c8[k + j]));
        REQUIRE(std::bit_cast<long long>(s) == std::bit_cast<long long>(s2[j]));
        REQUIRE(std::bit_cast<long long>(c) == std::bit_cast<long long>(c2[j]));
      }
    }
  }
}

TEST_CASE("the exact and the quick reduction agree at their border") {
  for (double x = 999'000.0; x < 1e6; x += 0.7310585) {
    double quick_sine, quick_cosine, above_sine, above_cosine;
    sine_cosine(x, quick_sine, quick_cosine);
    const double above = x + 1001.0;
    sine_cosine_exact(above, above_sine, above_cosine);
    CHECK(error_in_ulp(above_sine, std::sin(static_cast<long double>(above))) < 0.85);
    CHECK(error_in_ulp(quick_sine, std::sin(static_cast<long double>(x))) < 0.85);
  }
}

TEST_CASE("infinities and NaN give NaN; zero and denormal numbers give themselves") {
  using Limits = std::numeric_limits<double>;
  double s, c;
  for (const double x : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
    sine_cosine(x, s, c);
    CHECK(std::isnan(s));
    CHECK(std::isnan(c));
  }
  for (const double x : {0.0, Limits::denorm_min(), -1e-310, Limits::min()}) {
    sine_cosine(x, s, c);
    CHECK(s == x);
    CHECK(c == 1.0);
  }
  sine_cosine(Limits::max(), s, c);
  CHECK(error_in_ulp(s, std::sin(static_cast<long double>(Limits::max()))) < 0.85);
}
