// The linear systems of an implicit method: the solution solves them, whatever rows have to be
// exchanged.
#include <doctest/doctest.h>

#include <random>

#include "integrate/radau/newton_systems.hpp"

using namespace pendcore;

namespace {

template <class Number>
Number random_number() {
  static std::mt19937_64 random(11);
  static std::uniform_real_distribution any(-1.0, 1.0);
  if constexpr (std::is_same_v<Number, double>) {
    return any(random);
  } else {
    const double re = any(random);
    return {re, any(random)};
  }
}

template <class Any>
void fill(Any& matrix) {
  for (auto& one : matrix.reshaped()) one = random_number<typename Any::Scalar>();
}

/// With M = 1 - h B - h^2 A and random A, M, h, r and s: M y = h (s + h A r), x = h (r + y).
template <class Number, int links>
void check_solution(int n) {
  using System = NewtonSystem<Number, links>;
  System system(n);
  typename System::template Square<double> by_q(n, n);
  fill(by_q);
  fill(system.matrix);
  if (n > 1) system.matrix.diagonal().setZero();
  Eigen::Matrix<Number, links, 1> r(n), s(n);
  fill(r);
  fill(s);
  system.h = random_number<Number>();
  const auto matrix = system.matrix;
  auto x = r;
  auto y = s;
  REQUIRE(system.factor({}));
  system.solve(by_q, x, y);
  const auto side = (system.h * (s + system.h * (by_q * r))).eval();
  CHECK((matrix * y - side).norm() < 1e-12);
  CHECK((x - system.h * (r + y)).norm() < 1e-14);
}

template <class Number>
void check_solutions() {
  check_solution<Number, 1>(1);
  check_solution<Number, 2>(2);
  for (int n = 1; n < 12; ++n) check_solution<Number, Eigen::Dynamic>(n);
}

}  // namespace

TEST_CASE("real systems of any size are solved, also with zeros on the diagonal") {
  check_solutions<double>();
}

TEST_CASE("complex systems of any size are solved, also with zeros on the diagonal") {
  check_solutions<Complex>();
}

TEST_CASE("an elimination that is told not to go on ends early") {
  NewtonSystem<double, Eigen::Dynamic> system(200);
  system.matrix.setIdentity();
  int asked = 0;
  CHECK(!system.factor([&] { return ++asked < 3; }));
  CHECK(asked == 3);
  system.matrix.setIdentity();
  CHECK(system.factor([] { return true; }));
}
