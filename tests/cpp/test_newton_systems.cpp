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
Any filled(Eigen::Index rows, Eigen::Index columns) {
  Any matrix;
  matrix.resize(rows, columns);
  for (auto& one : matrix.reshaped()) one = random_number<typename Any::Scalar>();
  return matrix;
}

/// With M = 1 - h B - h^2 A and random A, M, h, r and s: M y = h (s + h A r), x = h (r + y).
template <class Number, int links>
void check_solution(int n) {
  using System = NewtonSystem<Number, links>;
  using Column = Eigen::Matrix<Number, links, 1>;
  System system(n);
  const auto by_q = filled<typename System::template Square<double>>(n, n);
  const auto r = filled<Column>(n, 1), s = filled<Column>(n, 1);
  system.h = random_number<Number>();
  system.matrix = filled<decltype(system.matrix)>(n, n);
  if (n > 1) system.matrix.diagonal().setZero();
  const auto matrix = system.matrix;
  auto x = r, y = s;
  REQUIRE(system.factor({}));
  system.solve(by_q, x, y);
  const auto side = (system.h * (s + system.h * (by_q * r))).eval();
  CHECK((matrix * y - side).norm() < 1e-12);
  CHECK((x - system.h * (r + y)).norm() < 1e-14);
}

}  // namespace

TEST_CASE_TEMPLATE("real and complex systems of any size are solved, also with a diagonal of zeros",
                   Number, double, Complex) {
  check_solution<Number, 1>(1);
  check_solution<Number, 2>(2);
  for (int n = 1; n < 12; ++n) check_solution<Number, Eigen::Dynamic>(n);
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
