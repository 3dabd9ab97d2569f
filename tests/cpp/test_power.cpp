// The powers of two of the step control against the library's.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "arithmetic/power.hpp"

using namespace pendcore;

TEST_CASE("the logarithm is right to 1e-9 over all magnitudes") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution exponent(-1000.0, 1000.0);
  for (int i = 0; i < 100'000; ++i) {
    const double x = std::exp2(exponent(random));
    CHECK(std::abs(approximate_log2(x) - std::log2(x)) < 1e-9);
  }
  CHECK(approximate_log2(1.0) == 0.0);
}

TEST_CASE("an error of zero counts as very small, not as a NaN") {
  CHECK(approximate_log2(0.0) < -1000.0);
  CHECK(approximate_log2(std::numeric_limits<double>::denorm_min()) < -1000.0);
  CHECK(approximate_log2(std::numeric_limits<double>::infinity()) > 1000.0);
}

TEST_CASE("the power is right to a relative 1e-10") {
  for (double x = -1000.0; x <= 1000.0; x += 0.0137) {
    CHECK(std::abs(approximate_exp2(x) / std::exp2(x) - 1.0) < 1e-10);
  }
}

TEST_CASE("the inverse of a power of two is exact, alone and in packs") {
  for (int k = -1022; k <= 1022; ++k) {
    const double x = std::ldexp(1.0, k);
    CHECK(inverse_of_power_of_two(x) == std::ldexp(1.0, -k));
    const Pack<4> pack = inverse_of_power_of_two(broadcast<Pack<4>>(x));
    for (int i = 0; i < 4; ++i) CHECK(pack[i] == std::ldexp(1.0, -k));
  }
}

TEST_CASE("the scaled power is right to a relative 1e-9") {
  std::mt19937_64 random(2);
  std::uniform_real_distribution exponent(-300.0, 300.0);
  for (const double power : {-0.25, -0.085, -0.0625, 0.1}) {
    for (int i = 0; i < 20'000; ++i) {
      const double x = std::exp2(exponent(random));
      const double gain = 0.01 * exponent(random);
      const double exact = std::exp2(gain) * std::pow(x, power);
      CHECK(std::abs(scaled_power(x, power, gain) / exact - 1.0) < 1e-9);
    }
  }
}
