// The core's own functions against the C library's: sine and cosine within an ulp of the 64-bit
// mantissa of long double, and lane by lane; exponential, logarithm and powers; two doubles.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "arithmetic/exponential.hpp"
#include "arithmetic/power.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "arithmetic/two_double.hpp"

using namespace pendcore;
using Limits = std::numeric_limits<double>;

namespace {

double error_in_ulp(double value, long double exact) {
  int exponent;
  std::frexp(static_cast<double>(exact), &exponent);
  const long double ulp = std::ldexp(1.0L, exponent - 53);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

/// The larger error of the sine and the cosine of an angle, in ulp.
double error_of(double s, double c, double angle) {
  const auto exact = static_cast<long double>(angle);
  return std::max(error_in_ulp(s, std::sin(exact)), error_in_ulp(c, std::cos(exact)));
}

/// Angles up to `range`: uniformly drawn ones, doubles next to multiples of pi/2, and small ones.
double angle(std::mt19937_64& random, double range, int i) {
  const double x = std::uniform_real_distribution(-range, range)(random);
  if (i % 3 == 1) return std::nearbyint(x * 0.6366197723675814) * 1.5707963267948966;
  if (i % 3 == 2) return x * std::exp2(std::uniform_real_distribution(-60.0, 0.0)(random));
  return x;
}

bool are_same(double a, double b) {
  return std::bit_cast<long long>(a) == std::bit_cast<long long>(b);
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
      worst = std::max(worst, error_of(s, c, x));
    }
    CHECK(worst < 0.85);
    CHECK(worst > 0.5);  // otherwise it is not measured
  }
  double s, c;
  sine_cosine(Limits::max(), s, c);
  CHECK(error_of(s, c, Limits::max()) < 0.85);
}

TEST_CASE("the exact and the quick reduction of angles agree at their border") {
  for (double x = 999'000.0; x < 1e6; x += 0.7310585) {
    double s, c;
    sine_cosine(x, s, c);
    CHECK(error_of(s, c, x) < 0.85);
    sine_cosine_exact(x + 1001.0, s, c);
    CHECK(error_of(s, c, x + 1001.0) < 0.85);
  }
}

TEST_CASE("every lane of every width has the same sine and cosine as the number alone") {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20'000; ++i) {
    Pack<8> x, s8, c8;
    for (int k = 0; k < 8; ++k) x[k] = angle(random, k == 3 ? 1e9 : 1e5, i + k);
    sine_cosine(x, s8, c8);
    for (int k = 0; k < 8; ++k) {
      Pack<2> s2, c2;
      sine_cosine(Pack<2>{x[k - k % 2], x[k - k % 2 + 1]}, s2, c2);
      double s, c;
      sine_cosine(x[k], s, c);
      REQUIRE(are_same(s, s8[k]));
      REQUIRE(are_same(c, c8[k]));
      REQUIRE(are_same(s, s2[k % 2]));
      REQUIRE(are_same(c, c2[k % 2]));
    }
  }
}

TEST_CASE("sines of infinities and NaN are NaN; zero and denormal numbers are their own") {
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
}

TEST_CASE("exp and log are within 2e-15, relatively, and powers within 1e-13") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution exponents(-700.0, 700.0);
  for (int i = 0; i < 200000; ++i) {
    const double x = exponents(random);
    REQUIRE(std::abs(exponential(x) / std::exp(x) - 1.0) < 2e-15);
    for (const double y : {std::exp(x), 1.0 + 1e-3 * x / 700.0}) {
      REQUIRE(std::abs(logarithm(y) - std::log(y)) <= 2e-15 * std::abs(std::log(y)));
    }
  }
  for (const double p : {1.0, 1.3, 2.0, 3.7}) {
    CHECK(power(0.0, p) == 0.0);
    for (double x = 1e-4; x < 30.0; x *= 1.37) {
      CHECK(power(x, p) == doctest::Approx(std::pow(x, p)).epsilon(1e-13));
    }
  }
}

TEST_CASE("the ends of exp and log") {
  CHECK(exponential(0.0) == 1.0);
  CHECK(exponential(-800.0) == 0.0);
  CHECK(exponential(-INFINITY) == 0.0);
  CHECK(exponential(800.0) == INFINITY);
  CHECK(std::isnan(exponential(NAN)));
  CHECK(logarithm(1.0) == 0.0);
  CHECK(logarithm(0.0) == -INFINITY);
  CHECK(logarithm(INFINITY) == INFINITY);
  CHECK(std::isnan(logarithm(-1.0)));
  CHECK(std::isnan(logarithm(NAN)));
}

TEST_CASE("powers of two of the step control: log2, exp2 and x^p over all magnitudes") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution exponents(-1000.0, 1000.0);
  for (int i = 0; i < 100'000; ++i) {
    const double x = std::exp2(exponents(random));
    CHECK(std::abs(approximate_log2(x) - std::log2(x)) < 1e-9);
  }
  for (double x = -1000.0; x <= 1000.0; x += 0.0137) {
    CHECK(std::abs(approximate_exp2(x) / std::exp2(x) - 1.0) < 1e-10);
  }
  for (const double power : {-0.25, -0.085, -0.0625, 0.1}) {
    for (int i = 0; i < 20'000; ++i) {
      const double x = std::exp2(0.3 * exponents(random)), gain = 0.003 * exponents(random);
      const double exact = std::exp2(gain) * std::pow(x, power);
      CHECK(std::abs(scaled_power(x, power, gain) / exact - 1.0) < 1e-9);
    }
  }
  CHECK(approximate_log2(1.0) == 0.0);
  CHECK(approximate_log2(0.0) < -1000.0);  // an error of zero is very small, and no NaN
  CHECK(approximate_log2(Limits::denorm_min()) < -1000.0);
  CHECK(approximate_log2(Limits::infinity()) > 1000.0);
}

TEST_CASE("the inverse of a power of two is exact, alone and in packs") {
  for (int k = -1022; k <= 1022; ++k) {
    const double x = std::ldexp(1.0, k);
    CHECK(inverse_of_power_of_two(x) == std::ldexp(1.0, -k));
    const Pack<4> pack = inverse_of_power_of_two(broadcast<Pack<4>>(x));
    for (int i = 0; i < 4; ++i) CHECK(pack[i] == std::ldexp(1.0, -k));
  }
}

TEST_CASE("time in two doubles: ten million steps of a tenth end where they should") {
  TwoDouble t;
  for (int i = 0; i < 10'000'000; ++i) t = t + 0.1;
  // 0.1 stands for 0.1000000000000000055511151231257827 in binary
  CHECK(t.high == 1e6);
  CHECK(t.low == doctest::Approx(10'000'000 * 5.5511151231257827e-18).epsilon(1e-6));
  const TwoDouble late = TwoDouble{1e17, 0.0} + 0.25;  // below the last bit
  CHECK(late.high == 1e17);
  CHECK(difference(1e17, late) == -0.25);
}
