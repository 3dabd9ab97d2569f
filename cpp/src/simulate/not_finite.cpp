#include "simulate/not_finite.hpp"

#include "dynamics/equations_of_motion.hpp"

namespace pendcore {
namespace {

std::vector<double> accelerations_of(const Scene& scene, double t, const std::vector<double>& y) {
  const std::size_t n = scene.links.size();
  std::vector<double> qdd(n);
  accelerations(equations_of_motion(scene), t, y.data(), y.data() + n, qdd.data());
  return qdd;
}

NotFinite look_at(const Scene& scene, double t, const std::vector<double>& y) {
  const int n = static_cast<int>(scene.links.size());
  if (const int bad = bad_component(y); bad >= 0) return {.component = bad};
  const int bad = bad_component(accelerations_of(scene, t, y));
  if (bad < 0) return {};
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    Scene alone = scene;
    alone.effects = {scene.effects[i]};
    if (bad_component(accelerations_of(alone, t, y)) >= 0) {
      return {.component = n + bad, .effect = static_cast<int>(i)};
    }
  }
  return {.component = n + bad};
}

}  // namespace

NotFinite find_what_is_not_finite(const Scene& scene, const IntegratorState& integrator,
                                  double t_end) {
  const std::size_t n = scene.links.size();
  // What is not finite may lie some steps ahead; the tangent leads roughly there.
  for (const double share : {0.0, 1.0, 4.0, 16.0, 64.0, 256.0}) {
    const double h = share * integrator.h;
    if ((integrator.t.high + h - t_end) * h > 0.0) break;
    std::vector<double> y(2 * n);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = integrator.y[i] + h * integrator.dydt[i];
    try {
      const NotFinite found = look_at(scene, integrator.t.high + h, y);
      if (found.component >= 0) return found;
    } catch (...) {  // a user's function threw, which the run did not call here
      return {};
    }
  }
  return {};
}

}  // namespace pendcore
