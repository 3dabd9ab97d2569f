// Which ensembles have lanes: nothing else would show that members run one by one, but their time.
#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "arithmetic/instruction_set.hpp"
#include "ensemble/lanes.hpp"
#include "pendcore/pendcore.hpp"
#include "simulate/step_watch.hpp"

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

/// Members of scenes; counts those that lanes leave to single runs. The last ones, which lanes
/// leave because most lanes are empty, are not counted.
class CountingSource final : public LaneSource {
 public:
  explicit CountingSource(std::vector<Scene> scenes) : scenes_(std::move(scenes)) {}
  const Scene* next(LaneMember& member) override {
    is_exhausted_ = begun_ == scenes_.size();
    if (is_exhausted_) return nullptr;
    const std::size_t n = scenes_[begun_].links.size();
    member.state.assign(2 * n, 0.1 + 0.02 * static_cast<double>(begun_));
    member.number = begun_;
    return &scenes_[begun_++];
  }
  const Scene& scene_of(std::size_t number) override { return scenes_[number]; }
  std::unique_ptr<StepWatch> watch(const Scene&) override { return nullptr; }
  bool watches() const override { return false; }
  bool watches_dense_output() const override { return false; }
  void ended(const LaneMember& member) override { CHECK(member.status == Status::finished); }
  void run_alone(std::size_t) override {
    if (!is_exhausted_) ++alone;
  }
  bool goes_on() override { return true; }

  int alone = 0;

 private:
  std::vector<Scene> scenes_;
  std::size_t begun_ = 0;
  bool is_exhausted_ = false;
};

/// The number of members, each a variation of a scene, that lanes leave to single runs.
int left_to_single_runs(const Scene& scene, const std::string& method,
                        const std::function<void(Scene&, int)>& vary) {
  std::vector<Scene> scenes(20, scene);
  for (int i = 0; i < 20; ++i) vary(scenes[i], i);
  Options options;
  options.method = method;
  options.store = Store::end;
  const auto lanes = make_lanes(scene, 0.0, 1.0, options);
  REQUIRE(lanes != nullptr);
  CountingSource source(scenes);
  lanes->run(source);
  return source.alone;
}

}  // namespace

TEST_CASE("members of other constants go in the lanes of a scene") {
  if (instruction_set() < least_of_special_kernels) return;
  const auto heavier = [](Scene& scene, int i) { scene.links[0].mass += 0.05 * i; };
  const DrivenPivot shaken{.y = Sinusoid{0.1, 5.0}};
  for (const std::size_t n : {2, 3, 4, 5, 6, 13, 33}) {
    const ViscousJoint damped{.joint = static_cast<int>(n), .damping = 0.1};
    CHECK(left_to_single_runs(chain(n), "taylor", heavier) == 0);
    CHECK(left_to_single_runs(chain(n, {shaken}), "taylor", heavier) == 0);
    CHECK(left_to_single_runs(chain(n, {damped}), "taylor", heavier) == 0);
  }
  CHECK(left_to_single_runs(chain(most_links_in_lanes), "taylor", heavier) == 0);
  const RodDrag drag{.link = 1, .drag_coefficient = 1.2, .diameter = 0.03};
  const auto wider = [](Scene& scene, int i) {
    scene.effects[0] = RodDrag{.link = 1, .drag_coefficient = 1.2, .diameter = 0.01 * i};
  };
  for (const std::size_t n : {1, 2, 3, 4}) {
    for (const char* method : {"dopri5", "dop853"}) {
      CHECK(left_to_single_runs(chain(n), method, heavier) == 0);
      CHECK(left_to_single_runs(chain(n, {shaken}), method, heavier) == 0);
      CHECK(left_to_single_runs(chain(n, {drag}), method, wider) == 0);
    }
  }
}

TEST_CASE("members of another form, or that are not allowed, are left to single runs") {
  if (instruction_set() < least_of_special_kernels) return;
  const auto at_odd = [](auto change) {
    return [change](Scene& scene, int i) {
      if (i % 2 == 1) change(scene);
    };
  };
  const ViscousJoint damped{.joint = 2, .damping = 0.1};
  const auto has_cubes = at_odd([](Scene& scene) {
    scene.effects[0] = ViscousJoint{.joint = 2, .damping = 0.1, .damping3 = 0.1};
  });
  CHECK(left_to_single_runs(chain(5, {damped}), "taylor", has_cubes) == 10);
  const auto has_no_rotor =
      at_odd([](Scene& scene) { scene.effects[0] = RotorInertia{.joint = 2, .armature = 0.0}; });
  CHECK(left_to_single_runs(chain(6, {RotorInertia{.joint = 2, .armature = 0.1}}), "taylor",
                            has_no_rotor) == 10);
  for (const std::size_t n : {3, 4}) {
    for (const char* method : {"dopri5", "dop853"}) {
      CHECK(left_to_single_runs(chain(n, {RotorInertia{.joint = 2, .armature = 0.1}}), method,
                                has_no_rotor) == 10);
    }
  }
  const auto is_negative = at_odd([](Scene& scene) { scene.links[1].mass = -0.5; });
  CHECK(left_to_single_runs(chain(2), "taylor", is_negative) == 10);
  CHECK(left_to_single_runs(chain(2), "dop853", is_negative) == 10);
}

TEST_CASE("scenes and methods that have lanes, and those that have none") {
  if (instruction_set() < least_of_special_kernels) return;
  for (const char* method : {"dopri5", "dop853", "dop853-radau5"}) {
    CHECK(have_lanes(chain(1), method));
    CHECK(have_lanes(chain(1, {DrivenPivot{.y = Sinusoid{0.1, 5.0}}}), method));
    CHECK(have_lanes(chain(2), method));
    CHECK(have_lanes(chain(3), method));
    CHECK(have_lanes(chain(4), method));
    CHECK(have_lanes(chain(3, {RotorInertia{.joint = 3, .armature = 0.1}}), method));
    CHECK(have_lanes(chain(4, {RotorInertia{.joint = 2, .armature = 0.1}}), method));
    CHECK_FALSE(have_lanes(chain(5), method));
    auto none = [](double, std::span<const double>, std::span<const double>, std::span<double>) {};
    for (const std::size_t n : {1, 2, 3, 4}) {
      CHECK_FALSE(have_lanes(chain(n, {CompiledUser::of(none)}), method));
    }
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
  CHECK(have_lanes(chain(most_links_in_lanes), "taylor"));
  CHECK_FALSE(have_lanes(chain(most_links_in_lanes + 1), "taylor"));
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
  CHECK(have_lanes(chain(3), "dopri5", both));
}
