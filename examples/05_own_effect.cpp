// An effect of your own, compiled: two wooden rods in water, whose lift exceeds their
// weight. Prints the same as 05_own_effect.py, whose function it is.
//
// In CMake: find_package(pendcore REQUIRED), and link with pendcore::pendcore.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <pendcore/pendcore.hpp>
#include <span>

constexpr double pi = std::numbers::pi;
constexpr double radius = 0.02, length = 0.5;  // m
// N on each rod: the weight of the water that it displaces.
constexpr double lift = 1000.0 * pi * radius * radius * length * 9.807;

int main() {
  // Adds generalised forces of the absolute angles, N m.
  auto buoyancy = [](double /*t*/, std::span<const double> q,
                     std::span<const double> /*qd*/, std::span<double> Q) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      Q[i] -= lift * length * (q.size() - i - 0.5) * std::cos(q[i]);
    }
  };
  const auto wood = pendcore::Link::uniform_rod(0.4, length);
  const pendcore::ViscousJoint damper_1{.joint = 1, .damping = 0.1};
  const pendcore::ViscousJoint damper_2{.joint = 2, .damping = 0.1};
  const pendcore::Scene scene{
      .links = {wood, wood},
      .effects = {pendcore::CompiledUser::of(buoyancy), damper_1, damper_2}};
  pendcore::Options options;
  options.ledger = true;
  const pendcore::Solution solution =
      pendcore::simulate(scene, {1.5, 1.5}, {0.0, 0.0}, 0.0, 30.0, options);

  const pendcore::StateView end = solution.back();
  for (int i = 0; i < 2; ++i) {
    std::printf("q_%d(30) = %.4f deg\n", i + 1, end.q(i) * 180.0 / pi);
  }
  // The ledger keeps, in this order: viscous, user.
  std::printf("work of the water %.6f J, lost in the joints %.6f J\n", end.accounts(1),
              end.accounts(0));
}
