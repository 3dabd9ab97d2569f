// All zeros of a function in a step are found, each once and with its direction, whatever lies at
// the ends; where a function turns negative first is located to the last bits.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "integrate/events/root.hpp"

using namespace pendcore;

namespace {

using Polynomial = std::vector<double>;

/// The coefficients of sign prod (theta - root).
Polynomial with_roots(const std::vector<double>& roots, double sign = 1.0) {
  Polynomial c{sign};
  for (const double root : roots) {
    c.insert(c.begin(), 0.0);
    for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] -= root * c[k + 1];
  }
  return c;
}

double at_one(const Polynomial& c) { return std::accumulate(c.begin(), c.end(), 0.0); }

double first(const Polynomial& c) {
  return first_negative(c.data(), static_cast<int>(c.size()) - 1);
}

std::vector<Root> roots_of(const Polynomial& c, double end, double noise = 1e-15) {
  std::vector<Root> found;
  find_roots(c.data(), static_cast<int>(c.size()) - 1, end, noise, found);
  return found;
}

void check_roots(const std::vector<Root>& found, const std::vector<Root>& exact, double relative) {
  REQUIRE(found.size() == exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    REQUIRE(std::abs(found[i].theta - exact[i].theta) <= relative * (1.0 + exact[i].theta));
    REQUIRE(found[i].direction == exact[i].direction);
  }
}

}  // namespace

TEST_CASE("every root is found, in order, with its direction, also at the end but not the start") {
  struct Known {
    Polynomial c;
    std::vector<Root> roots;
    double relative = 1e-13;
  };
  const Polynomial four = with_roots({0.125, 0.375, 0.5, 0.875, -0.5, 1.5});
  const std::vector<Known> all = {
      {four, {{0.125, 1}, {0.375, -1}, {0.5, 1}, {0.875, -1}}},
      {with_roots({0.5, 0.5, 2.0}, -1.0), {{0.5, 0}}, 1e-8},  // a double root touches
      {with_roots({0.5, 0.5, 0.5}), {{0.5, 1}}, 1e-4},        // a triple one is flat: 1e-15^(1/3)
      {{0.25 + 1e-12, -1.0, 1.0}, {}},                        // turns clear of zero
      {{0.25, -1.0, 1.0}, {{0.5, 0}}},
      {{0.25 - 1e-12, -1.0, 1.0}, {{0.5 - 1e-6, -1}, {0.5 + 1e-6, 1}}, 1e-8},
      {{0.0, 1.0}, {}},
      {{0.0, 0.0, 0.0}, {}},
      {{0.0, 1.0, -1.0}, {{1.0, -1}}, 0.0},
      {{0.0, 1.0, -2.0}, {{0.5, -1}}, 1e-15},
      {with_roots({0.4321, 0.4321 + 1e-9, -0.5}), {{0.4321, 0}}, 1e-8},  // one, within rounding
  };
  for (const auto& [c, roots, relative] : all) check_roots(roots_of(c, at_one(c)), roots, relative);
}

TEST_CASE("two roots close together are both found") {
  for (const double gap : {0.3, 1e-2, 1e-4, 1e-6}) {
    const Polynomial c = with_roots({0.4321, 0.4321 + gap, -0.5});
    const auto found = roots_of(c, at_one(c));
    check_roots(found, {{0.4321, -1}, {0.4321 + gap, 1}}, 1e-14 / gap);
    CHECK(found[1].theta - found[0].theta == doctest::Approx(gap).epsilon(1e-8));
    const Polynomial dips = with_roots({0.4321, 0.4321 + gap, -0.5, 1.7}, -1.0);
    CHECK(first(dips) == doctest::Approx(0.4321).epsilon(1e-15 / gap));
  }
}

TEST_CASE("the state at the end decides the sign there") {
  const Polynomial rises{-1.0, 1.0};  // zero at 1
  CHECK(roots_of(rises, -1e-17).empty());
  CHECK(roots_of(rises, 0.0).size() == 1);
  check_roots(roots_of(rises, 1e-17), {{1.0, 1}}, 0.0);
  // A root that the polynomial has just before the end, and the state does not have; and one that
  // the polynomial does not have: it lies at the end.
  CHECK(roots_of({-1.0 + 1e-16, 1.0}, -1e-17).empty());
  check_roots(roots_of({-1.0 - 1e-15, 1.0}, 1e-17), {{1.0, 1}}, 1e-15);
}

TEST_CASE("a function that is zero within rounding everywhere has no root") {
  CHECK(roots_of({0.0, 1e-17, -3e-17, 2e-17}, 0.0).empty());
  CHECK(roots_of({0.0, 1e-10, -3e-10, 2e-10}, 0.0).size() == 2);  // 0.5, and the end
}

TEST_CASE("random polynomials of any degree: as many roots as samples see, where they see all") {
  std::mt19937_64 random(11);
  std::uniform_real_distribution any(-0.3, 1.3);
  for (int round = 0; round < 20000; ++round) {
    const int degree = 1 + round % 9;  // beyond, coefficients hardly determine the roots
    std::vector<double> roots(degree);
    for (double& root : roots) root = any(random);
    std::ranges::sort(roots);
    std::vector<Root> inside;
    bool is_clear = true;
    for (int i = 0; i < degree; ++i) {
      is_clear &= i == 0 || roots[i] - roots[i - 1] > 0.02;
      is_clear &= std::abs(roots[i]) > 0.02 && std::abs(roots[i] - 1.0) > 0.02;
      const int direction = (degree - i) % 2 == 1 ? 1 : -1;
      if (roots[i] > 0.0 && roots[i] < 1.0) inside.push_back({roots[i], direction});
    }
    const Polynomial c = with_roots(roots);
    if (is_clear) check_roots(roots_of(c, at_one(c)), inside, 1e-6);
  }
}

TEST_CASE("directions alternate, and their number fits the signs at the ends") {
  std::mt19937_64 random(12);
  std::normal_distribution any;
  for (int round = 0; round < 50000; ++round) {
    Polynomial c(2 + round % 30);
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

TEST_CASE("where a function turns negative first is found, or that it does so nowhere") {
  struct Known {
    Polynomial c;
    double theta;
    double relative = 1e-14;
  };
  const std::vector<Known> all = {
      {{0.3, -1.0}, 0.3, 1e-15},           {with_roots({0.7, 2.0, -1.0, 3.0}, -1.0), 0.7},
      {with_roots({0.0, 0.6}, -1.0), 0.6},  // starts at zero
      {{1e-18, 1.0, -2.0}, 0.5},           {{-1e-18, 1.0, -2.0}, 0.5},
      {{1.0 - 1e-12, -1.0}, 1.0 - 1e-12},
  };
  for (const auto& [c, theta, relative] : all) {
    CHECK(first(c) == doctest::Approx(theta).epsilon(relative));
  }
  const std::vector<Polynomial> none = {
      {1.0, 0.5}, with_roots({1.2, 1.5}), with_roots({-0.2, -0.1, 1.01}, -1.0),
      {0.0, 1.0}, with_roots({0.5, 0.5}), {1.0, -1.0},  // zero at 1, not negative
  };
  for (const Polynomial& c : none) CHECK(first(c) > 1.0);
}

TEST_CASE("random polynomials turn negative first where many samples see it, or before") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution any(-1.0, 1.0);
  for (int round = 0; round < 5000; ++round) {
    Polynomial c(5);
    for (double& x : c) x = any(random);
    c[0] = std::abs(c[0]);
    const auto value = [&](double x) {
      return (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
    };
    double seen = 2.0;
    for (int i = 1; i <= 4000 && seen > 1.0; ++i) {
      if (value(i / 4000.0) < 0.0) seen = i / 4000.0;
    }
    const double found = first(c);
    if (seen > 1.0) continue;
    REQUIRE(found <= seen);
    if (found < seen - 1.0 / 4000.0) REQUIRE(value(found + 1e-9) < 1e-9);  // between two samples
  }
}
