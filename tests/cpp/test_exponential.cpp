// Exponential, logarithm and power against the C library's, which are accurate to an ulp or so.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "arithmetic/exponential.hpp"

using namespace pendcore;

TEST_CASE("exp and log are within 2e-15, relatively") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution exponents(-700.0, 700.0);
  for (int i = 0; i < 200000; ++i) {
    const double x = exponents(random);
    REQUIRE(std::abs(exponential(x) / std::exp(x) - 1.0) < 2e-15);
    const double y = std::exp(x);
    REQUIRE(std::abs(logarithm(y) - std::log(y)) <= 2e-15 * std::abs(std::log(y)));
    const double near_one = 1.0 + 1e-3 * x / 700.0;
    REQUIRE(std::abs(logarithm(near_one) - std::log(near_one)) <=
            2e-15 * std::abs(std::log(near_one)));
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

TEST_CASE("powers") {
  for (const double p : {1.0, 1.3, 2.0, 3.7}) {
    for (double x = 1e-4; x < 30.0; x *= 1.37) {
      CHECK(power(x, p) == doctest::Approx(std::pow(x, p)).epsilon(1e-13));
    }
    CHECK(power(0.0, p) == 0.0);
  }
}
