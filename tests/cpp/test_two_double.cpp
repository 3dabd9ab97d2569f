// Time in two doubles.
#include <doctest/doctest.h>

#include <cmath>

#include "arithmetic/two_double.hpp"

using namespace pendcore;

TEST_CASE("ten million steps of a tenth end where they should") {
  TwoDouble t;
  double plain = 0.0;
  for (int i = 0; i < 10'000'000; ++i) {
    t = t + 0.1;
    plain += 0.1;
  }
  // 0.1 stands for 0.1000000000000000055511151231257827 in binary
  const double exact_excess = 10'000'000 * 5.5511151231257827e-18;
  CHECK(t.high == 1e6);
  CHECK(t.low == doctest::Approx(exact_excess).epsilon(1e-6));
  CHECK(std::abs(plain - 1e6) > 1e-5);  // what two doubles are there for
}

TEST_CASE("a difference keeps digits below the last bit") {
  const TwoDouble t = TwoDouble{1e17, 0.0} + 0.25;
  CHECK(t.high == 1e17);
  CHECK(difference(1e17, t) == -0.25);
}
