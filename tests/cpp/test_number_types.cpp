// The right-hand side is written once: packs of trajectories and dual numbers use it unchanged.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <random>

#include "arithmetic/dual.hpp"
#include "dynamics/closed_form/double_pendulum.hpp"
#include "dynamics/closed_form/double_pendulum_with_effects.hpp"
#include "dynamics/closed_form/single_pendulum.hpp"
#include "pendcore/effects.hpp"

using namespace pendcore;

namespace {

const Scene uneven{.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)},
                   .gravity = 9.81};

}  // namespace

TEST_CASE("four trajectories in a pack have the same bits as each alone") {
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

TEST_CASE("a dual number has the same bits in its value, and the derivative beside it") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution any(0.1, 3.0);
  auto check = [&](auto f) {
    const Pair x{any(random), any(random)};
    const Pair along{any(random), -any(random)};
    const double h = 1e-6;
    const Dual<Pair> found = f(Dual<Pair>(x, along));
    const Pair ahead = f(Pair(x + h * along));
    const Pair behind = f(Pair(x - h * along));
    for (int i = 0; i < 2; ++i) {
      CHECK(found.value[i] == f(x)[i]);
      CHECK(found.slope[i] == doctest::Approx((ahead[i] - behind[i]) / (2 * h)).epsilon(1e-7));
    }
  };
  for (int round = 0; round < 20; ++round) {
    check([](const auto& x) { return exponential(-(x * x)); });
    check([](const auto& x) { return power(x, 1.0) + power(x, 2.0) - power(x, 2.7); });
    check([](const auto& x) { return absolute(-x) * x - absolute(x); });
    check([](const auto& x) { return 1.0 / (x * x); });
    check([](const auto& x) { return fma(x, other(x), before(x) * after(x)); });
    check([]<class V>(const V& x) {
      V s, c;
      sine_cosine(x, s, c);
      return V(s * (c * c));
    });
  }
}

TEST_CASE("one link in a pack has the same bits as one alone") {
  const Scene rod{.links = {Link::uniform_rod(1.3, 0.8)}, .gravity = 9.81};
  const SinglePendulum pendulum(Inertia(rod), rod.gravity);
  const Pack<4> q{0.1, -2.0, 3.0, 1e4};
  const Pack<4> together = pendulum.accelerations(q, Pack<4>{});
  for (int k = 0; k < 4; ++k) {
    const double alone = pendulum.accelerations(double{q[k]}, 0.0);
    CHECK(together[k] == alone);
  }
}

TEST_CASE("with effects, too, trajectories in a pack have the same bits as each alone") {
  Scene scene = uneven;
  scene.effects = {ViscousJoint{.joint = 2, .damping = 0.3, .damping2 = 0.2, .damping3 = 0.1},
                   TorsionalSpring{.joint = 1, .stiffness = 2.0, .rest_angle = 0.4},
                   RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.1, .wind = {3, 1}},
                   Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
                   Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}},
                   RotorInertia{.joint = 2, .armature = 0.05},
                   DrivenPivot{.x = Sinusoid{0.1, 5.0, 0.0}, .y = Sinusoid{0.05, 11.0, 0.2}}};
  const EffectsInRows<Pair> effects(scene);
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
