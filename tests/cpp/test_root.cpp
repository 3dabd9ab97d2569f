// Root location: every sign change is found, and located to the last bits.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "integrate/events/root.hpp"
#include "polynomials.hpp"

using namespace pendcore;

namespace {

double first(const std::vector<double>& c) {
  return first_negative(c.data(), static_cast<int>(c.size()) - 1);
}

}  // namespace

TEST_CASE("one root is found to the last bits") {
  CHECK(first({0.3, -1.0}) == doctest::Approx(0.3).epsilon(1e-15));
  CHECK(first(with_roots({0.7, 2.0, -1.0, 3.0}, -1.0)) == doctest::Approx(0.7).epsilon(1e-14));
}

TEST_CASE("two roots in one step are both found") {
  for (const double gap : {0.3, 1e-2, 1e-4, 1e-6}) {
    const double low = 0.4321;
    const auto c = with_roots({low, low + gap, -0.5, 1.7}, -1.0);
    CHECK(first(c) == doctest::Approx(low).epsilon(1e-15 / gap));
  }
}

TEST_CASE("no root is found where there is none, outside the step or where it only touches") {
  CHECK(first({1.0, 0.5}) > 1.0);
  CHECK(first(with_roots({1.2, 1.5}, 1.0)) > 1.0);
  CHECK(first(with_roots({-0.2, -0.1, 1.01}, -1.0)) > 1.0);
  CHECK(first(with_roots({0.5, 0.5}, 1.0)) > 1.0);
}

TEST_CASE("a function that starts at zero turns negative where it does so next") {
  CHECK(first(with_roots({0.0, 0.6}, -1.0)) == doctest::Approx(0.6).epsilon(1e-14));
  CHECK(first({1e-18, 1.0, -2.0}) == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(first({-1e-18, 1.0, -2.0}) == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(first({0.0, 1.0}) > 1.0);
}

TEST_CASE("a root at the end of the step counts where the sign has changed") {
  CHECK(first({1.0, -1.0}) > 1.0);  // zero at 1, not negative
  CHECK(first({1.0 - 1e-12, -1.0}) == doctest::Approx(1.0));
}

TEST_CASE("random polynomials: the result agrees with many samples") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution any(-1.0, 1.0);
  for (int round = 0; round < 5000; ++round) {
    std::vector<double> c(5);
    for (double& x : c) x = any(random);
    c[0] = std::abs(c[0]);
    double seen = 2.0;
    for (int i = 1; i <= 4000 && seen > 1.0; ++i) {
      const double x = i / 4000.0;
      if ((((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0] < 0.0) seen = x;
    }
    const double found = first(c);
    if (seen <= 1.0) {
      REQUIRE(found <= seen);
      if (found < seen - 1.0 / 4000.0) {  // a dip between two samples
        const double x = found + 1e-9;
        REQUIRE((((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0] < 1e-9);
      }
    }
  }
}
