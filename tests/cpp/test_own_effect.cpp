// A user's own effect in C++: what can be called with spans acts like a built-in effect.
#include <doctest/doctest.h>

#include <stdexcept>

#include "pendcore/pendcore.hpp"

using namespace pendcore;

namespace {

Solution run(const Scene& scene) {
  Options options;
  options.rtol = {1e-12};
  options.atol = {1e-13};
  const std::size_t n = scene.links.size();
  return simulate(scene, std::vector<double>(n, 0.4), std::vector<double>(n, 1.0), 0.0, 2.0,
                  options);
}

}  // namespace

TEST_CASE("a callable acts as the effect that it computes, whatever the number of links") {
  const double damping = 0.3;
  auto damp = [&](double /*t*/, std::span<const double> /*q*/, std::span<const double> qd,
                  std::span<double> Q) { Q[0] -= damping * qd[0]; };
  for (const std::size_t n : {1, 2, 3, 5}) {
    const std::vector<Link> links(n, Link::uniform_rod(1.0, 1.0));
    const Solution own = run({.links = links, .effects = {CompiledUser::of(damp)}});
    const Solution built_in =
        run({.links = links, .effects = {ViscousJoint{.joint = 1, .damping = damping}}});
    REQUIRE(own.status == Status::finished);
    for (std::size_t i = 0; i < 2 * n; ++i) {
      CHECK(own.y_reached[i] == doctest::Approx(built_in.y_reached[i]).epsilon(1e-10));
    }
    CHECK(run({.links = links}).y_reached[0] != doctest::Approx(own.y_reached[0]).epsilon(1e-3));
  }
}

TEST_CASE("an exception in a callable ends the run and is kept with what was computed") {
  auto fail = [](double t, std::span<const double>, std::span<const double>, std::span<double>) {
    if (t > 1.0) throw std::runtime_error("out of reach");
  };
  const Scene scene{.links = Scene::textbook().links, .effects = {CompiledUser::of(fail)}};
  const Solution solution = run(scene);
  CHECK(solution.status == Status::callback_error);
  CHECK(solution.t_reached > 0.5);
  CHECK_THROWS_WITH(std::rethrow_exception(solution.error), "out of reach");
  auto never = [](double, std::span<const double>, std::span<const double>, std::span<double>) {
    throw std::runtime_error("not even once");
  };
  const Solution none = run({.links = scene.links, .effects = {CompiledUser::of(never)}});
  CHECK(none.status == Status::callback_error);
  CHECK(none.t_reached == 0.0);
  CHECK_THROWS_WITH(std::rethrow_exception(none.error), "not even once");
}
