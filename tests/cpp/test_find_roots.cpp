// All zeros of a function in a step are found, each once and with its direction, whatever lies at
// the ends.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "integrate/events/root.hpp"
#include "polynomials.hpp"

using namespace pendcore;

namespace {

double at_one(const std::vector<double>& c) {
  double sum = 0.0;
  for (const double x : c) sum += x;
  return sum;
}

std::vector<Root> roots_of(const std::vector<double>& c, double end, double noise = 1e-15) {
  std::vector<Root> found;
  find_roots(c.data(), static_cast<int>(c.size()) - 1, end, noise, found);
  return found;
}
std::vector<Root> roots_of(const std::vector<double>& c) { return roots_of(c, at_one(c)); }

}  // namespace

TEST_CASE("every root is found, in order, with its direction") {
  const auto found = roots_of(with_roots({0.125, 0.375, 0.5, 0.875, -0.5, 1.5}, 1.0));
  REQUIRE(found.size() == 4);
  const double exact[] = {0.125, 0.375, 0.5, 0.875};
  for (int i = 0; i < 4; ++i) {
    CHECK(found[i].theta == doctest::Approx(exact[i]).epsilon(1e-13));
    CHECK(found[i].direction == (i % 2 == 0 ? 1 : -1));
  }
}

TEST_CASE("two roots close together are both found, until rounding makes them one") {
  for (const double gap : {1e-2, 1e-4, 1e-6}) {
    const auto found = roots_of(with_roots({0.4321, 0.4321 + gap, -0.5}, 1.0));
    REQUIRE(found.size() == 2);
    CHECK(found[0].direction == -1);
    CHECK(found[1].direction == 1);
    CHECK(found[0].theta == doctest::Approx(0.4321).epsilon(1e-14 / gap));
    CHECK(found[1].theta - found[0].theta == doctest::Approx(gap).epsilon(1e-8));
  }
  const auto touches = roots_of(with_roots({0.4321, 0.4321 + 1e-9, -0.5}, 1.0));
  REQUIRE(touches.size() == 1);
  CHECK(touches[0].direction == 0);
}

TEST_CASE("a double root touches, a triple one crosses") {
  const auto twice = roots_of(with_roots({0.5, 0.5, 2.0}, -1.0));
  REQUIRE(twice.size() == 1);
  CHECK(twice[0].direction == 0);
  CHECK(twice[0].theta == doctest::Approx(0.5).epsilon(1e-8));
  const auto thrice = roots_of(with_roots({0.5, 0.5, 0.5}, 1.0));
  REQUIRE(thrice.size() == 1);
  CHECK(thrice[0].direction == 1);
  CHECK(thrice[0].theta == doctest::Approx(0.5).epsilon(1e-4));  // flat: 1e-15^(1/3)
}

TEST_CASE("a turning point that stays clear of zero is not a root") {
  CHECK(roots_of({0.25 + 1e-12, -1.0, 1.0}).empty());
  CHECK(roots_of({0.25, -1.0, 1.0}).size() == 1);
  CHECK(roots_of({0.25 - 1e-12, -1.0, 1.0}).size() == 2);
}

TEST_CASE("a zero at the start is not a root, and a zero at the end is") {
  CHECK(roots_of({0.0, 1.0}).empty());
  CHECK(roots_of({0.0, 0.0, 0.0}).empty());
  const auto leaves_and_returns = roots_of({0.0, 1.0, -1.0});
  REQUIRE(leaves_and_returns.size() == 1);
  CHECK(leaves_and_returns[0].theta == 1.0);
  CHECK(leaves_and_returns[0].direction == -1);
  const auto between = roots_of({0.0, 1.0, -2.0});
  REQUIRE(between.size() == 1);
  CHECK(between[0].theta == doctest::Approx(0.5).epsilon(1e-15));
}

TEST_CASE("the state at the end decides the sign there") {
  const std::vector<double> rises{-1.0, 1.0};  // zero at 1
  CHECK(roots_of(rises, -1e-17).empty());
  CHECK(roots_of(rises, 0.0).size() == 1);
  REQUIRE(roots_of(rises, 1e-17).size() == 1);
  CHECK(roots_of(rises, 1e-17)[0].theta == 1.0);
  // A root that the polynomial has just before the end, and the state does not have.
  CHECK(roots_of({-1.0 + 1e-16, 1.0}, -1e-17).empty());
  // A root that the polynomial does not have: it lies at the end.
  const auto missing = roots_of({-1.0 - 1e-15, 1.0}, 1e-17);
  REQUIRE(missing.size() == 1);
  CHECK(missing[0].theta == doctest::Approx(1.0).epsilon(1e-15));
}

TEST_CASE("a function that is zero within rounding everywhere has no root") {
  CHECK(roots_of({0.0, 1e-17, -3e-17, 2e-17}, 0.0).empty());
  CHECK(roots_of({0.0, 1e-10, -3e-10, 2e-10}, 0.0, 1e-15).size() == 2);  // 0.5, and the end
}

TEST_CASE("random polynomials of any degree: as many roots as samples see, where they see all") {
  std::mt19937_64 random(11);
  std::uniform_real_distribution any(-0.3, 1.3);
  for (int round = 0; round < 20000; ++round) {
    const int degree = 1 + round % 15;
    std::vector<double> roots(degree);
    for (double& root : roots) root = any(random);
    std::ranges::sort(roots);
    std::vector<double> inside;
    bool is_clear = true;
    for (int i = 0; i < degree; ++i) {
      is_clear &= i == 0 || roots[i] - roots[i - 1] > 0.02;
      is_clear &= std::abs(roots[i]) > 0.02 && std::abs(roots[i] - 1.0) > 0.02;
      if (roots[i] > 0.0 && roots[i] < 1.0) inside.push_back(roots[i]);
    }
    if (!is_clear || degree > 9) continue;  // beyond, coefficients hardly determine the roots
    const auto found = roots_of(with_roots(roots, 1.0));
    REQUIRE(found.size() == inside.size());
    for (std::size_t i = 0; i < inside.size(); ++i) {
      REQUIRE(found[i].theta == doctest::Approx(inside[i]).epsilon(1e-6));
    }
  }
}

TEST_CASE("directions alternate, and their number fits the signs at the ends") {
  std::mt19937_64 random(12);
  std::normal_distribution any;
  for (int round = 0; round < 50000; ++round) {
    std::vector<double> c(2 + round % 30);
    for (double& x : c) x = any(random) * (round % 3 == 0 ? 1e-16 : 1.0);
    const double end = round % 5 == 0 ? 0.0 : round % 7 == 0 ? -at_one(c) : at_one(c);
    int side = sign(c[0]);
    double before = 0.0;
    for (const Root& root : roots_of(c, end)) {
      REQUIRE(root.theta > before);
      REQUIRE(root.theta <= 1.0);
      before = root.theta;
      if (root.direction == 0) continue;
      REQUIRE((side == 0 || side == -root.direction));
      side = root.theta == 1.0 && end == 0.0 ? 0 : root.direction;
    }
    if (sign(c[0]) != 0 && end != 0.0) REQUIRE(side == sign(end));
  }
}

TEST_CASE("a sampled function: a sample that is zero is a root, once") {
  std::vector<Root> found;
  auto f = [](double theta) { return theta < 0.4 ? 0.4 - theta : theta > 0.6 ? 0.6 - theta : 0.0; };
  std::vector<TurningPoint> samples;
  for (int i = 1; i < 10; ++i) samples.push_back({0.1 * i, f(0.1 * i)});
  find_roots(f, f(0.0), samples, f(1.0), 0.0, found);
  REQUIRE(found.size() == 1);
  CHECK(found[0].direction == -1);
  CHECK(found[0].theta >= 0.4);
  CHECK(found[0].theta <= 0.6);
}
