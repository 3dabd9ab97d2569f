// The right-hand side is written once: packs of trajectories, dual numbers and three states at once
// have the bits of each alone. And what equations hold: HeldJoints cost time where laws never
// change.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "dynamics/closed_form/double_pendulum.hpp"
#include "dynamics/closed_form/double_pendulum_with_effects.hpp"
#include "dynamics/closed_form/single_pendulum.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/jacobian.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

const std::vector<Link> rods(2, Link::uniform_rod(1.0, 1.0));
const Scene uneven{.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)},
                   .gravity = 9.81};

/// Two links: bare, with couples whose torque also depends on time, and with a joint that is held.
const std::vector<Scene> of_two_links = {
    uneven,
    {.links = rods,
     .gravity = 9.81,
     .effects = {ViscousJoint{.joint = 2, .damping = 0.3, .damping3 = 0.1},
                 TorsionalSpring{.joint = 1, .stiffness = 2.0, .rest_angle = 0.4},
                 RotorInertia{.joint = 2, .armature = 0.05},
                 Motor{.joint = 1, .table = Table{.t = {-5.0, 5.0}, .torque = {0.0, 3.0}}}}},
    {.links = rods, .effects = {Lock{.joint = 1}}},
    {.links = rods, .effects = {Lock{.joint = 2}}}};

/// Laws with corners, which no kernel for three states has: |w| w, drag and Stribeck's friction.
const Scene of_corners{
    .links = rods,
    .effects = {
        ViscousJoint{.joint = 2, .damping = 0.3, .damping2 = 0.2},
        RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.1, .wind = {3, 1}},
        DryJointFriction{.joint = 1, .coulomb = 0.3, .static_ = 0.6, .stribeck_velocity = 0.5}}};

/// Nine links with every kind of law on some of them, and joint 4 held.
Scene long_chain() {
  Scene scene{.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)}, .gravity = 9.81};
  scene.links.resize(9, Link::uniform_rod(1.0, 0.3));
  scene.effects = of_corners.effects;
  scene.effects.insert(
      scene.effects.end(),
      {ViscousJoint{.joint = 7, .damping = 0.3, .damping3 = 0.1},
       TorsionalSpring{.joint = 9, .stiffness = 2.0, .rest_angle = 0.4},
       DryJointFriction{.joint = 6, .coulomb = 0.1, .static_ = 0.2, .exponent = 1.5},
       DryJointFriction{.joint = 5, .coulomb = 0.1, .static_ = 0.3, .stribeck_velocity = 0.2},
       RodDrag{.link = 9, .drag_coefficient = 1.0, .diameter = 0.2},
       Motor{.joint = 3, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
       Motor{.joint = 8, .pd = PD{2.0, 0.3, 1.0}},
       DrivenPivot{.x = Sinusoid{0.1, 5.0, 0.0}, .y = Sinusoid{0.05, 11.0, 0.2}},
       RotorInertia{.joint = 2, .armature = 0.05}, Payload{.mass = 0.3}, Lock{.joint = 4}});
  return scene;
}

bool are_same(double a, double b) {
  return std::bit_cast<long long>(a) == std::bit_cast<long long>(b);
}

/// Random numbers within a range on both sides of zero.
struct Random {
  std::mt19937_64 engine;
  std::uniform_real_distribution<double> within;
  Random(unsigned seed, double range) : engine(seed), within(-range, range) {}
  double operator()() { return within(engine); }
};

/// Accelerations f(t, q, qd) of four trajectories in a pack are those of each alone.
template <class Accelerations>
void check_lanes(Random any, int rounds, const Accelerations& f) {
  for (int round = 0; round < rounds; ++round) {
    Two<Pack<4>> q, qd;
    for (Pack<4>* const pack : {&q.first, &q.second, &qd.first, &qd.second}) {
      for (int k = 0; k < 4; ++k) (*pack)[k] = any();
    }
    const double t = any();
    const Two<Pack<4>> together = f(t, q, qd);
    for (int k = 0; k < 4; ++k) {
      const Pair alone = f(t, Pair{q.first[k], q.second[k]}, Pair{qd.first[k], qd.second[k]});
      REQUIRE(are_same(together.first[k], alone[0]));
      REQUIRE(are_same(together.second[k], alone[1]));
    }
  }
}

}  // namespace

TEST_CASE("trajectories in a pack have the same bits as each alone") {
  const DoublePendulum bare(uneven, Inertia(uneven));
  check_lanes(Random(3, 10.0), 1000,
              [&](double, const auto& q, const auto& qd) { return bare.accelerations(q, qd); });
  Scene scene = uneven;
  scene.effects = {ViscousJoint{.joint = 2, .damping = 0.3, .damping2 = 0.2, .damping3 = 0.1},
                   TorsionalSpring{.joint = 1, .stiffness = 2.0, .rest_angle = 0.4},
                   RodDrag{.link = 2, .drag_coefficient = 1.2, .diameter = 0.1, .wind = {3, 1}},
                   Motor{.joint = 2, .sinusoid = Sinusoid{0.5, 3.0, 0.1}},
                   Motor{.joint = 1, .pd = PD{2.0, 0.3, 1.0}},
                   RotorInertia{.joint = 2, .armature = 0.05},
                   DrivenPivot{.x = Sinusoid{0.1, 5.0, 0.0}, .y = Sinusoid{0.05, 11.0, 0.2}}};
  const EffectsInRows<Pair> effects(scene);
  const DoublePendulumWithEffects<Parts::everything> busy(scene, Inertia(scene), &effects);
  check_lanes(Random(5, 4.0), 200, [&](double t, const auto& q, const auto& qd) {
    return busy.accelerations(t, q, qd);
  });
  const Scene rod{.links = {Link::uniform_rod(1.3, 0.8)}, .gravity = 9.81};
  const SinglePendulum pendulum(Inertia(rod), rod.gravity);
  const Pack<4> q{0.1, -2.0, 3.0, 1e4};
  const Pack<4> together = pendulum.accelerations(q, Pack<4>{});
  for (int k = 0; k < 4; ++k) {
    CHECK(are_same(together[k], pendulum.accelerations(double{q[k]}, 0.0)));
  }
}

TEST_CASE("three states at once have the bits of each state alone" *
          doctest::skip(!has_special_kernels_of_rare_runs)) {
  Random any(9, 4.0);
  for (const Scene& scene : of_two_links) {
    const EquationsOfMotion equations = equations_of_motion(scene);
    const RightHandSide rates = right_hand_side(equations);
    REQUIRE(static_cast<bool>(rates.compute_three));
    for (int round = 0; round < 100; ++round) {
      std::vector<double> t(3), y(12), together(12), alone(12);
      for (std::vector<double>* const row : {&t, &y}) std::ranges::generate(*row, std::ref(any));
      rates.compute_three(rates.form, t.data(), y.data(), together.data());
      for (int k = 0; k < 3; ++k) {
        const double* const state = y.data() + 4 * k;
        std::copy_n(state + 2, 2, alone.data() + 4 * k);
        rates(t[k], state, state + 2, alone.data() + 4 * k + 2);
      }
      REQUIRE(std::ranges::equal(together, alone, are_same));
    }
  }
}

TEST_CASE("the Jacobian has the bits of each direction alone, beside those of the rates") {
  Random any(10, 4.0);
  std::vector<Scene> scenes = of_two_links;
  scenes.insert(scenes.end(), {of_corners, {.links = {3, rods[0]}, .gravity = 9.81}, long_chain()});
  for (const Scene& scene : scenes) {
    const auto n = static_cast<Eigen::Index>(scene.links.size());
    const EquationsOfMotion equations = equations_of_motion(scene);
    const RightHandSide rates = right_hand_side(equations);
    const Jacobian jacobian(scene, equations_of_motion(scene));
    for (int round = 0; round < 100; ++round) {
      Vector y(2 * n), qdd(n), plain(n), change(n);
      std::ranges::generate(y, std::ref(any));
      const double* const qd = y.data() + n;
      const double t = any();
      Matrix by_q(n, n), by_qd(n, n);
      jacobian(t, y.data(), qd, by_q, by_qd);
      rates(t, y.data(), qd, plain.data());
      const Matrix directions = Matrix::Identity(2 * n, 2 * n);
      const Matrix dq = directions.leftCols(n), dqd = directions.rightCols(n);
      Matrix together(2 * n, n);
      jacobian.along(t, y.data(), qd, static_cast<int>(2 * n), dq.data(), dqd.data(), qdd.data(),
                     together.data());
      REQUIRE(std::ranges::equal(qdd, plain, are_same));
      for (Eigen::Index j = 0; j < 2 * n; ++j) {
        const Vector column = j < n ? by_q.col(j) : by_qd.col(j - n);
        jacobian.along(t, y.data(), qd, 1, &dq(j, 0), &dqd(j, 0), qdd.data(), change.data());
        REQUIRE(std::ranges::equal(qdd, plain, are_same));
        REQUIRE(std::ranges::equal(column, change, are_same));
        REQUIRE(std::ranges::equal(together.row(j), change, are_same));
      }
    }
  }
}

TEST_CASE("equations have HeldJoints where laws may change, and only there") {
  const Sinusoid wave{.amplitude = 1.0, .angular_frequency = 3.0};
  const auto check = [](bool has_held_joints, const std::vector<Effect>& effects) {
    const Scene scene{.links = rods, .effects = effects};
    const EquationsOfMotion equations = equations_of_motion(scene);
    CHECK(equations.are_steady() == !laws_may_change(scene));
    CHECK((equations.held_joints != nullptr) == has_held_joints);
  };
  check(false, {});
  check(false, {ViscousJoint{.joint = 2, .damping = 0.1, .damping3 = 0.1},
                RotorInertia{.joint = 2, .armature = 0.1}, Motor{.joint = 1, .sinusoid = wave},
                DrivenPivot{.x = wave}});
  check(true, {ViscousJoint{.joint = 2, .damping2 = 0.1}});
  check(true, {Motor{.joint = 1, .sinusoid = wave, .limit = 0.5}});
  check(true, {DryJointFriction{.joint = 2, .coulomb = 0.1}});
  check(true, {JointStop{.joint = 2, .range = {-1.0, 1.0}}});
  check(true, {Lock{.joint = 2}});
}
