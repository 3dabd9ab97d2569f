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

double sum(const LobattoPoints& points, const LobattoPoints::Numbers& weights, int power) {
  double total = 0.0;
  for (std::size_t j = 0; j < points.count; ++j) {
    total += weights[j] * std::pow(points.theta[j], power);
  }
  return total;
}

/// By how much the integral of theta^power from 0 on is wrong, and its integral.
void check(const LobattoPoints& points, const LobattoPoints::Sums& sums, int power) {
  const double once = std::pow(sums.theta, power + 1) / (power + 1);
  const double twice = once * sums.theta / (power + 2);
  CHECK(std::abs(sum(points, sums.once, power) - once) < rounding);
  CHECK(std::abs(sum(points, sums.twice, power) - twice) < rounding);
}

}  // namespace

TEST_CASE("over the whole interval powers up to twice the number of points less 3 are exact") {
  for (int count = 5; count <= 9; ++count) {
    const LobattoPoints& points = lobatto_points(count);
    const LobattoPoints::Sums& to_end = points.sums[points.count];
    for (int power = 0; power <= 2 * count - 3; ++power) {
      CHECK(std::abs(sum(points, to_end.once, power) - 1.0 / (power + 1)) < rounding);
    }
    CHECK(std::abs(sum(points, to_end.once, 2 * count - 2) - 1.0 / (2 * count - 1)) > 1e-10);
    for (int power = 0; power < count; ++power) check(points, to_end, power);
  }
}

TEST_CASE("up to a point, the points before it integrate squares, or what goes through them all") {
  for (int count = 5; count <= 9; ++count) {
    const LobattoPoints& points = lobatto_points(count);
    CHECK(points.theta[points.count - 1] == 1.0);
    for (int i = 1; i < count; ++i) {
      for (int power = 0; power < std::min(i, 3); ++power) check(points, points.sums[i], power);
      for (int j = i; j < count; ++j) CHECK(points.sums[i].once[j] == 0.0);
    }
  }
}

TEST_CASE("the polynomials are the double integrals within the interval") {
  for (int count = 5; count <= 9; ++count) {
    const LobattoPoints& points = lobatto_points(count);
    for (int power = 0; power < count; ++power) {
      for (const double theta : {0.1, 0.4, 0.73, 1.0}) {
        double total = 0.0;
        for (std::size_t j = 0; j < points.count; ++j) {
          double value = 0.0;
          for (std::size_t k = points.twice_at[j].size(); k-- > 0;) {
            value = theta * value + points.twice_at[j][k];
          }
          total += value * std::pow(points.theta[j], power);
        }
        const double exact = std::pow(theta, power + 2) / ((power + 1) * (power + 2));
        CHECK(std::abs(total - exact) < rounding);
      }
    }
  }
}

TEST_CASE("there are 5 to 9 points") {
  CHECK_THROWS_AS(lobatto_points(4), std::invalid_argument);
  CHECK_THROWS_AS(lobatto_points(10), std::invalid_argument);
}
