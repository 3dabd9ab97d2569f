#include "dynamics/energetics/reactions.hpp"

#include <vector>

#include "dynamics/energetics/ledger.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "pendcore/effects/payload.hpp"
#include "text/message.hpp"

namespace pendcore {

void reactions(const Scene& scene, EffectsInForce& effects, double t, std::span<const double> q,
               std::span<const double> qd, std::span<const double> qdd, std::span<double> forces) {
  const std::size_t n = scene.links.size();
  mass_center_accelerations(scene, t, q, qd, qdd, forces);
  if (effects.has_modes) choose_modes(effects, t, q.data(), qd.data(), true);
  std::vector<double> loads(2 * n);
  effect_forces(scene, effects, t, q.data(), qd.data(), loads);
  double beyond_x = 0.0;
  double beyond_y = 0.0;
  for (const Payload& payload : effects_of<Payload>(scene)) {
    // a_tip = a_C + (L - c)(qdd n - qd^2 u)
    const std::size_t i = n - 1;
    const double rest = scene.links[i].length - scene.links[i].center;
    double u[2];
    directions(q.subspan(i), u);
    const double square = qd[i] * qd[i];
    const double x = forces[2 * i] + rest * (-qdd[i] * u[1] - square * u[0]);
    const double y = forces[2 * i + 1] + rest * (qdd[i] * u[0] - square * u[1]);
    beyond_x += payload.mass * x;
    beyond_y += payload.mass * (y - scene.gravity);
  }
  for (std::size_t i = n; i-- > 0;) {
    const double m = scene.links[i].mass;
    forces[2 * i] = beyond_x += m * forces[2 * i] - loads[2 * i];
    forces[2 * i + 1] = beyond_y += m * (forces[2 * i + 1] - scene.gravity) - loads[2 * i + 1];
  }
}

}  // namespace pendcore
