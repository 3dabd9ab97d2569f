// The textbook's double pendulum, section 2.1: two rods, let go from 45 and 60 degrees.
// By ode45, as in the book; a run that names no method takes a quicker one for the same
// accuracy. Prints the same numbers, to the last bit, as 01_textbook.py.
//
// In CMake: find_package(pendcore REQUIRED), and link with pendcore::pendcore.
#include <cstdio>
#include <numbers>
#include <pendcore/pendcore.hpp>

int main() {
  constexpr double pi = std::numbers::pi;
  pendcore::Options options;
  options.method = "ode45";
  const pendcore::Solution solution = pendcore::simulate(
      pendcore::Scene::textbook(), {pi / 4, pi / 3}, {0.0, 0.0}, 0.0, 5.0, options);

  const pendcore::StateView end = solution.back();
  for (int i = 0; i < 2; ++i) {
    std::printf("q_%d(5) = %.17g rad, ", i + 1, end.q(i));
    std::printf("qd_%d(5) = %.17g rad/s\n", i + 1, end.qd(i));
  }
}
