// When the first link turns back, and when the tip passes under the pivot from right to left. The
// third passage ends the run.
#include <cstdio>
#include <pendcore/pendcore.hpp>

int main() {
  using namespace pendcore::events;
  const RateZero turn{.link = 1};
  const TipLine vertical{.normal = {1.0, 0.0}};  // through the pivot; positive on the right
  const pendcore::Solution run = pendcore::simulate(
      pendcore::Scene::textbook(), {0.8, 1.0}, {0.0, 0.0}, 0.0, 10.0,
      {.rtol = 1e-10, .events = {turn, {.function = vertical, .direction = -1, .terminal = 3}}});

  for (const pendcore::FoundEvent& one : run.found) {
    std::printf("%.6f s: the %s at q %.6f %.6f\n", one.t,
                one.event == 0 ? "first link turns" : "tip passes", one.y[0], one.y[1]);
  }
  std::printf("%s\n", run.message.c_str());
}
