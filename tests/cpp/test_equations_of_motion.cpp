// What equations hold, which no result shows: HeldJoints cost time where laws never change.
#include <doctest/doctest.h>

#include <utility>
#include <vector>

#include "pendcore/pendcore.hpp"

using namespace pendcore;

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
