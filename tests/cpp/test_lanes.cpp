// Which ensembles have lanes: nothing else would show that members run one by one, but their time.
#include <doctest/doctest.h>

#include "pendcore/ensemble/lanes.hpp"
#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

bool have_lanes(const Scene& scene, const std::string& method, const Options& asked = {}) {
  Options options = asked;
  options.method = method;
  options.store = options.t_eval.empty() ? Store::end : Store::times;
  return make_lanes(scene, 0.0, 1.0, options) != nullptr;
}

Scene chain(std::size_t n, std::vector<Effect> effects = {}) {
  return {.links = std::vector<Link>(n, Link::uniform_rod(1.0, 1.0)),
          .effects = std::move(effects)};
}

}  // namespace

TEST_CASE("scenes and methods that have lanes, and those that have none") {
  if (instruction_set() < least_of_special_kernels) return;
  for (const char* method : {"dopri5", "dop853", "dop853-radau5"}) {
    CHECK(have_lanes(chain(1), method));
    CHECK(have_lanes(chain(1, {DrivenPivot{.y = Sinusoid{0.1, 5.0}}}), method));
    CHECK(have_lanes(chain(2), method));
    CHECK_FALSE(have_lanes(chain(3), method));
  }
  CHECK(have_lanes(chain(1), "auto"));
  CHECK_FALSE(have_lanes(chain(1), "taylor"));
  for (const std::size_t n : {2, 3, 4}) {
    CHECK(have_lanes(chain(n), "auto"));
    CHECK(have_lanes(chain(n, {ViscousJoint{.joint = 2, .damping = 0.1}}), "taylor"));
    CHECK_FALSE(have_lanes(chain(n, {DryJointFriction{.joint = 2, .coulomb = 0.1}}), "taylor"));
  }
  CHECK(have_lanes(chain(2, {DrivenPivot{.y = Sinusoid{0.1, 5.0}}}), "auto"));
  CHECK(have_lanes(chain(6, {RotorInertia{.joint = 3, .armature = 0.1}}), "taylor"));
  CHECK_FALSE(have_lanes(chain(7), "taylor"));
  CHECK_FALSE(have_lanes(chain(2), "radau5"));
}

TEST_CASE("times and events have lanes, but for functions of one's own") {
  if (instruction_set() < least_of_special_kernels) return;
  Options times, with_events, both, with_function;
  times.t_eval = both.t_eval = {0.5, 1.0};
  with_events.events = {{.function = events::LinkAngle{.link = 1, .value = 0.5}},
                        {.function = events::TipLine{.point = {0.1, 0.2}, .normal = {1.0, 0.0}}}};
  both.events = with_events.events;
  const auto own = [](double t, std::span<const double>, std::span<const double>) { return t; };
  with_function.events = {{.function = events::Function{.f = own}}};
  for (const std::size_t n : {1, 2, 3, 4}) {
    const char* const method = n == 1 ? "dop853" : "taylor";
    CHECK(have_lanes(chain(n), method, times));
    CHECK(have_lanes(chain(n), method, with_events));
    CHECK(have_lanes(chain(n), method, both));
    CHECK_FALSE(have_lanes(chain(n), method, with_function));
  }
  CHECK(have_lanes(chain(2), "dopri5", both));
}
