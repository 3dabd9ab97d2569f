// Solves the textbook's case and prints the two angles after 5 s, in rad, to the last bit.
#include <cstdio>
#include <numbers>
#include <pendcore/pendcore.hpp>

int main() {
  constexpr double pi = std::numbers::pi;
  const pendcore::Solution solution =
      pendcore::simulate(pendcore::Scene::textbook(), {pi / 4, pi / 3}, {0.0, 0.0}, 0.0, 5.0);
  // The last row holds q_1, q_2, qd_1, qd_2.
  const double* last = solution.states.data() + solution.states.size() - 4;
  std::printf("%a %a\n", last[0], last[1]);
}
