// What equations hold, which no result shows: HeldJoints cost time where laws never change.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <utility>
#include <vector>

#include "dynamics/equations_of_motion.hpp"
#include "dynamics/jacobian.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

/// Two links: bare, with couples whose torque also depends on time, and with a joint that is held.
const std::vector<Scene> of_two_links = {
    {.links = {Link::uniform_rod(2.5, 0.7), Link::point_mass(0.4, 1.6)}, .gravity = 9.81},
    {.links = std::vector<Link>(2, Link::uniform_rod(1.0, 1.0)),
     .gravity = 9.81,
     .effects = {ViscousJoint{.joint = 2, .damping = 0.3, .damping3 = 0.1},
                 TorsionalSpring{.joint = 1, .stiffness = 2.0, .rest_angle = 0.4},
                 RotorInertia{.joint = 2, .armature = 0.05},
                 Motor{.joint = 1, .table = Table{.t = {-5.0, 5.0}, .torque = {0.0, 3.0}}}}},
    {.links = std::vector<Link>(2, Link::uniform_rod(1.0, 1.0)), .effects = {Lock{.joint = 1}}},
    {.links = std::vector<Link>(2, Link::uniform_rod(1.0, 1.0)), .effects = {Lock{.joint = 2}}}};

bool are_same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<long long, double>,
                            std::bit_cast<long long, double>);
}

}  // namespace

TEST_CASE("equations have HeldJoints where laws may change, and only there") {
  const Sinusoid wave{.amplitude = 1.0, .angular_frequency = 3.0};
  const auto have_held_joints = [](std::vector<Effect> effects) {
    const Scene scene{.links = std::vector<Link>(2, Link::uniform_rod(1.0, 1.0)),
                      .effects = std::move(effects)};
    const EquationsOfMotion equations = equations_of_motion(scene);
    CHECK(equations.are_steady() == !laws_may_change(scene));
    return equations.held_joints != nullptr;
  };
  CHECK_FALSE(have_held_joints({}));
  CHECK_FALSE(have_held_joints({ViscousJoint{.joint = 2, .damping = 0.1, .damping3 = 0.1},
                                RotorInertia{.joint = 2, .armature = 0.1},
                                Motor{.joint = 1, .sinusoid = wave}, DrivenPivot{.x = wave}}));
  CHECK(have_held_joints({ViscousJoint{.joint = 2, .damping2 = 0.1}}));
  CHECK(have_held_joints({Motor{.joint = 1, .sinusoid = wave, .limit = 0.5}}));
  CHECK(have_held_joints({DryJointFriction{.joint = 2, .coulomb = 0.1}}));
  CHECK(have_held_joints({JointStop{.joint = 2, .range = {-1.0, 1.0}}}));
  CHECK(have_held_joints({Lock{.joint = 2}}));
}

TEST_CASE("three states at once have the bits of each state alone" *
          doctest::skip(!has_special_kernels_of_rare_runs)) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution any(-4.0, 4.0);
  for (const Scene& scene : of_two_links) {
    const EquationsOfMotion equations = equations_of_motion(scene);
    const RightHandSide rates = right_hand_side(equations);
    REQUIRE(static_cast<bool>(rates.compute_three));
    for (int round = 0; round < 100; ++round) {
      std::vector<double> t(3), y(12), together(12), alone(12);
      std::ranges::generate(t, [&] { return any(random); });
      std::ranges::generate(y, [&] { return any(random); });
      rates.compute_three(rates.form, t.data(), y.data(), together.data());
      for (int k = 0; k < 3; ++k) {
        const double* const state = y.data() + 4 * k;
        std::copy_n(state + 2, 2, alone.data() + 4 * k);
        rates(t[k], state, state + 2, alone.data() + 4 * k + 2);
      }
      REQUIRE(are_same(together, alone));
    }
  }
}

TEST_CASE("the Jacobian has the bits of each direction alone") {
  std::mt19937_64 random(10);
  std::uniform_real_distribution any(-4.0, 4.0);
  for (const Scene& scene : of_two_links) {
    const Jacobian jacobian(scene, equations_of_motion(scene));
    for (int round = 0; round < 100; ++round) {
      std::vector<double> y(4), found(8), alone(8);
      Matrix by_q(2, 2), by_qd(2, 2);
      std::ranges::generate(y, [&] { return any(random); });
      const double t = any(random);
      jacobian(t, y.data(), y.data() + 2, by_q, by_qd);
      for (int j = 0; j < 4; ++j) {
        double direction[4] = {};
        direction[j] = 1.0;
        double qdd[2], change[2];
        jacobian.along(t, y.data(), y.data() + 2, direction, direction + 2, qdd, change);
        for (int i = 0; i < 2; ++i) {
          found[2 * j + i] = j < 2 ? by_q(i, j) : by_qd(i, j - 2);
          alone[2 * j + i] = change[i];
        }
      }
      REQUIRE(are_same(found, alone));
    }
  }
}
