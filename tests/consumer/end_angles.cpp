// Solves the textbook's case and prints the two angles after 5 s, in rad, to the last bit.
#include <cstdio>
#include <numbers>
#include <pendcore/pendcore.hpp>

int main() {
  constexpr double pi = std::numbers::pi;
  const pendcore::Solution solution =
      pendcore::simulate(pendcore::Scene::textbook(), {pi / 4, pi / 3}, {0.0, 0.0}, 0.0, 5.0);
  std::printf("%a %a\n", solution.back().q(0), solution.back().q(1));
}
