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

using Names = std::vector<std::string>;

Scene chain(std::size_t n, std::vector<Effect> effects = {}) {
  return {.links = std::vector<Link>(n, Link::uniform_rod(1.0, 1.0)),
          .effects = std::move(effects)};
}

Options options_of(const std::string& method, Options options = {}) {
  options.method = method;
  options.store = options.t_eval.empty() ? Store::end : Store::times;
  return options;
}

/// Checks whether the runs of a scene by each of the methods have lanes.
void check_lanes(bool expected, const Scene& scene, const Names& methods,
                 const Options& options = {}) {
  for (const std::string& method : methods) {
    CAPTURE(method);
    CAPTURE(scene.links.size());
    CHECK((make_lanes(scene, 0.0, 1.0, options_of(method, options)) != nullptr) == expected);
  }
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
  void run_alone(std::size_t) override { alone += is_exhausted_ ? 0 : 1; }
  bool goes_on() override { return true; }

  int alone = 0;

 private:
  std::vector<Scene> scenes_;
  std::size_t begun_ = 0;
  bool is_exhausted_ = false;
};

/// Checks how many of twenty members, each a variation of a scene, lanes leave to single runs.
void check_left_alone(int expected, const Scene& scene, const Names& methods,
                      const std::function<void(Scene&, int)>& vary) {
  std::vector<Scene> scenes(20, scene);
  for (int i = 0; i < 20; ++i) vary(scenes[i], i);
  for (const std::string& method : methods) {
    const Options options = options_of(method);
    const auto lanes = make_lanes(scene, 0.0, 1.0, options);
    REQUIRE(lanes != nullptr);
    CountingSource source(scenes);
    lanes->run(source);
    CHECK(source.alone == expected);
  }
}

const bool has_lanes = instruction_set() >= least_of_special_kernels;
const Names explicit_ones = {"dopri5", "dop853"};
const DrivenPivot shaken{.y = Sinusoid{0.1, 5.0}};
const RotorInertia rotor{.joint = 2, .armature = 0.1};

}  // namespace

TEST_CASE("members of other constants go in the lanes of a scene" * doctest::skip(!has_lanes)) {
  const auto heavier = [](Scene& scene, int i) { scene.links[0].mass += 0.05 * i; };
  for (const std::size_t n : {2, 3, 4, 5, 6, 13, 33}) {
    const ViscousJoint damped{.joint = static_cast<int>(n), .damping = 0.1};
    for (const Scene& scene : {chain(n), chain(n, {shaken}), chain(n, {damped})}) {
      check_left_alone(0, scene, {"taylor"}, heavier);
    }
  }
  check_left_alone(0, chain(most_links_in_lanes), {"taylor"}, heavier);
  const auto drag = [](int i) {
    return RodDrag{.link = 1, .drag_coefficient = 1.2, .diameter = 0.01 * i};
  };
  for (const std::size_t n : {1, 2, 3, 4}) {
    check_left_alone(0, chain(n), explicit_ones, heavier);
    check_left_alone(0, chain(n, {shaken}), explicit_ones, heavier);
    check_left_alone(0, chain(n, {drag(3)}), explicit_ones,
                     [&](Scene& scene, int i) { scene.effects[0] = drag(i); });
  }
}

TEST_CASE("members of another form, or that are not allowed, are left to single runs" *
          doctest::skip(!has_lanes)) {
  const auto at_odd = [](auto change) {
    return [change](Scene& scene, int i) {
      if (i % 2 == 1) change(scene);
    };
  };
  check_left_alone(10, chain(5, {ViscousJoint{.joint = 2, .damping = 0.1}}), {"taylor"},
                   at_odd([](Scene& scene) {
                     scene.effects[0] = ViscousJoint{.joint = 2, .damping = 0.1, .damping3 = 0.1};
                   }));
  const auto has_no_rotor =
      at_odd([](Scene& scene) { scene.effects[0] = RotorInertia{.joint = 2, .armature = 0.0}; });
  check_left_alone(10, chain(6, {rotor}), {"taylor"}, has_no_rotor);
  check_left_alone(10, chain(3, {rotor}), explicit_ones, has_no_rotor);
  check_left_alone(10, chain(4, {rotor}), explicit_ones, has_no_rotor);
  check_left_alone(10, chain(2), {"taylor", "dop853"},
                   at_odd([](Scene& scene) { scene.links[1].mass = -0.5; }));
}

TEST_CASE("scenes and methods that have lanes, and those that have none" *
          doctest::skip(!has_lanes)) {
  const Names with_a_pair = {"dopri5", "dop853", "dop853-radau5"};
  auto none = [](double, std::span<const double>, std::span<const double>, std::span<double>) {};
  for (const std::size_t n : {1, 2, 3, 4}) {
    check_lanes(true, chain(n), {"auto", "dop853-radau5"});
    check_lanes(false, chain(n, {CompiledUser::of(none)}), with_a_pair);
  }
  for (const std::size_t n : {2, 3, 4}) {
    check_lanes(false, chain(n, {DryJointFriction{.joint = 2, .coulomb = 0.1}}), {"taylor"});
  }
  check_lanes(true, chain(1, {shaken}), with_a_pair);
  check_lanes(true, chain(2, {shaken}), {"auto"});
  check_lanes(true, chain(3, {rotor}), with_a_pair);
  check_lanes(true, chain(4, {rotor}), with_a_pair);
  check_lanes(false, chain(5), with_a_pair);
  check_lanes(false, chain(1), {"taylor"});
  check_lanes(false, chain(2), {"radau5"});
  check_lanes(false, chain(most_links_in_lanes + 1), {"taylor"});
}

TEST_CASE("times and events have lanes, but for functions of one's own" *
          doctest::skip(!has_lanes)) {
  Options times, with_events, both, with_function;
  times.t_eval = both.t_eval = {0.5, 1.0};
  with_events.events =
      both.events = {{.function = events::LinkAngle{.link = 1, .value = 0.5}},
                     {.function = events::TipLine{.point = {0.1, 0.2}, .normal = {1.0, 0.0}}}};
  const auto own = [](double t, std::span<const double>, std::span<const double>) { return t; };
  with_function.events = {{.function = events::Function{.f = own}}};
  for (const std::size_t n : {1, 2, 3, 4}) {
    const Names method = {n == 1 ? "dop853" : "taylor"};
    for (const Options* const one : {&times, &with_events, &both}) {
      check_lanes(true, chain(n), method, *one);
    }
    check_lanes(false, chain(n), method, with_function);
  }
  check_lanes(true, chain(2), {"dopri5"}, both);
  check_lanes(true, chain(3), {"dopri5"}, both);
}
