// The right-hand side is written once: packs of trajectories and dual numbers use it as it is.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <random>

#include "pendcore/dynamics/double_pendulum.hpp"
#include "pendcore/dynamics/double_pendulum_with_effects.hpp"
#include "pendcore/dynamics/single_pendulum.hpp"

using namespace pendcore;

/// value + slope epsilon, epsilon^2 = 0: as much of a dual number as the equations need.
namespace dual {

struct Dual {
  double value;
  double slope;
};
Dual operator-(const Dual& x) { return {-x.value, -x.slope}; }
Dual operator*(const Dual& x, const Dual& y) {
  return {x.value * y.value, x.value * y.slope + x.slope * y.value};
}
Dual operator/(double x, const Dual& y) {
  return {x / y.value, -x * y.slope / (y.value * y.value)};
}
Dual fma(const Dual& a, const Dual& b, const Dual& c) {
  const Dual product = a * b;
  return {product.value + c.value, product.slope + c.slope};
}
void sine_cosine(const Dual& x, Dual& sine, Dual& cosine) {
  sine = {std::sin(x.value), std::cos(x.value) * x.slope};
  cosine = {std::cos(x.value), -std::sin(x.value) * x.slope};
}

}  // namespace dual

template <>
dual::Dual pendcore::broadcast<dual::Dual>(double x) {
  return {x, 0.0};
}

namespace {

using dual::Dual;

const Scene uneven{.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)},
                   .gravity = 9.81};

}  // namespace

TEST_CASE("four trajectories in a pack have the bits of each alone") {
  const DoublePendulum pendulum(uneven, Inertia(uneven));
  std::mt19937_64 random(3);
  std::uniform_real_distribution any(-10.0, 10.0);
  for (int round = 0; round < 1000; ++round) {
    Two<Pack<4>> q, qd;
    for (int k = 0; k < 4; ++k) {
      q.first[k] = any(random);
      q.second[k] = any(random);
      qd.first[k] = any(random);
      qd.second[k] = any(random);
    }
    const Two<Pack<4>> together = pendulum.accelerations(q, qd);
    for (int k = 0; k < 4; ++k) {
      const Pair alone =
          pendulum.accelerations(Pair{q.first[k], q.second[k]}, Pair{qd.first[k], qd.second[k]});
      REQUIRE(std::bit_cast<long long>(together.first[k]) == std::bit_cast<long long>(alone[0]));
      REQUIRE(std::bit_cast<long long>(together.second[k]) == std::bit_cast<long long>(alone[1]));
    }
  }
}

TEST_CASE("dual numbers give the derivative of the right-hand side") {
  const DoublePendulum pendulum(uneven, Inertia(uneven));
  const Pair q{0.3, 1.9};
  const Pair qd{2.0, -3.0};
  const double h = 1e-6;
  for (int j = 0; j < 4; ++j) {  // with respect to q_1, q_2, qd_1, qd_2
    auto slope = [j](int k) { return j == k ? 1.0 : 0.0; };
    const Two<Dual> exact = pendulum.accelerations(Two<Dual>{{q[0], slope(0)}, {q[1], slope(1)}},
                                                   Two<Dual>{{qd[0], slope(2)}, {qd[1], slope(3)}});
    const Pair dq{h * slope(0), h * slope(1)};
    const Pair dqd{h * slope(2), h * slope(3)};
    const Pair ahead = pendulum.accelerations(Pair(q + dq), Pair(qd + dqd));
    const Pair behind = pendulum.accelerations(Pair(q - dq), Pair(qd - dqd));
    CHECK(exact.first.slope == doctest::Approx((ahead[0] - behind[0]) / (2 * h)).epsilon(1e-8));
    CHECK(exact.second.slope == doctest::Approx((ahead[1] - behind[1]) / (2 * h)).epsilon(1e-8));
  }
}

TEST_CASE("one link in a pack has the bits of one alone") {
  const Scene rod{.links = {Link::uniform_rod(1.3, 0.8)}, .gravity = 9.81};
  const SinglePendulum pendulum(Inertia(rod), rod.gravity);
  const Pack<4> q{0.1, -2.0, 3.0, 1e4};
  const Pack<4> together = pendulum.accelerations(q, Pack<4>{});
  for (int k = 0; k < 4; ++k) {
    const double alone = pendulum.accelerations(double{q[k]}, 0.0);
    CHECK(together[k] == alone);
  }
}

TEST_CASE("with effects, too, trajectories in a pack have the bits of each alone") {
  Scene scene = uneven;
  scene.effects = {ViscousJoint{.joint = 2, .damping = 0.3, .damping2 = 0.2, .damping3 = 0.1},
                   TorsionalSpring{.joint = 1, .stiffness = 2.0, .rest_angle = 0.4},
                   RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.1, .wind = {3, 1}},
                   Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
                   Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}},
                   RotorInertia{.joint = 2, .armature = 0.05},
                   DrivenPivot{.x = Sinusoid{0.1, 5.0, 0.0}, .y = Sinusoid{0.05, 11.0, 0.2}}};
  const ActingEffects<Pair> effects(scene);
  const DoublePendulumWithEffects<Parts::everything> pendulum(scene, Inertia(scene), &effects);
  std::mt19937_64 random(5);
  std::uniform_real_distribution any(-4.0, 4.0);
  for (int round = 0; round < 200; ++round) {
    Two<Pack<4>> q, qd;
    for (int k = 0; k < 4; ++k) {
      q.first[k] = any(random);
      q.second[k] = any(random);
      qd.first[k] = any(random);
      qd.second[k] = any(random);
    }
    const double t = any(random);
    const Two<Pack<4>> together = pendulum.accelerations(t, q, qd);
    for (int k = 0; k < 4; ++k) {
      const Pair alone =
          pendulum.accelerations(t, Pair{q.first[k], q.second[k]}, Pair{qd.first[k], qd.second[k]});
      REQUIRE(std::bit_cast<long long>(together.first[k]) == std::bit_cast<long long>(alone[0]));
      REQUIRE(std::bit_cast<long long>(together.second[k]) == std::bit_cast<long long>(alone[1]));
    }
  }
}
