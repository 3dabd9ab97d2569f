// The weights of Lobatto quadratures integrate powers exactly, as far as they should.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/lobatto_points.hpp"

using namespace pendcore;

namespace {

/// Weights are sums of large coefficients. An error needs few digits.
constexpr double rounding = 1e-11;

/// By how much the sum of a power at the points is off, with weights for each.
template <class Weight>
double off(const LobattoPoints& points, int power, double exact, Weight weight) {
  double total = -exact;
  for (std::size_t j = 0; j < points.count; ++j)
    total += weight(j) * std::pow(points.theta[j], power);
  return std::abs(total);
}

/// The double integral of theta^power from 0 on.
double twice(double theta, int power) {
  return std::pow(theta, power + 2) / ((power + 1) * (power + 2));
}

void check(const LobattoPoints& points, const LobattoPoints::Sums& sums, int power) {
  const double once = std::pow(sums.theta, power + 1) / (power + 1);
  CHECK(off(points, power, once, [&](auto j) { return sums.once[j]; }) < rounding);
  const double exact = twice(sums.theta, power);
  CHECK(off(points, power, exact, [&](auto j) { return sums.twice[j]; }) < rounding);
}

}  // namespace

TEST_CASE("weights integrate powers exactly, as far as they should") {
  for (int count = 5; count <= 9; ++count) {
    const LobattoPoints& points = lobatto_points(count);
    CHECK(points.theta[points.count - 1] == 1.0);
    // Over the whole interval, powers up to twice the number of points less 3.
    const LobattoPoints::Sums& to_end = points.sums[points.count];
    const auto off_by = [&](int power) {
      return off(points, power, 1.0 / (power + 1), [&](auto j) { return to_end.once[j]; });
    };
    for (int power = 0; power <= 2 * count - 3; ++power) CHECK(off_by(power) < rounding);
    CHECK(off_by(2 * count - 2) > 1e-10);
    for (int power = 0; power < count; ++power) check(points, to_end, power);
    // Up to a point, squares by the points before it, or what goes through them all.
    for (int i = 1; i < count; ++i) {
      for (int power = 0; power < std::min(i, 3); ++power) check(points, points.sums[i], power);
      for (int j = i; j < count; ++j) CHECK(points.sums[i].once[j] == 0.0);
    }
    // Within the interval, the polynomials are the double integrals.
    for (const double theta : {0.1, 0.4, 0.73, 1.0}) {
      const auto value = [&](std::size_t j) {
        double sum = 0.0;
        for (std::size_t k = points.twice_at[j].size(); k-- > 0;) {
          sum = theta * sum + points.twice_at[j][k];
        }
        return sum;
      };
      for (int power = 0; power < count; ++power) {
        CHECK(off(points, power, twice(theta, power), value) < rounding);
      }
    }
  }
}

TEST_CASE("there are 5 to 9 points") {
  CHECK_THROWS_AS(lobatto_points(4), std::invalid_argument);
  CHECK_THROWS_AS(lobatto_points(10), std::invalid_argument);
}
