#include "pendcore/dynamics/reactions.hpp"

namespace pendcore {

void reactions(const Scene& scene, std::span<const double> q, std::span<const double> qd,
               std::span<const double> qdd, std::span<double> forces) {
  mass_center_accelerations(scene, q, qd, qdd, forces);
  double beyond_x = 0.0;
  double beyond_y = 0.0;
  for (std::size_t i = scene.links.size(); i-- > 0;) {
    const double m = scene.links[i].mass;
    forces[2 * i] = beyond_x += m * forces[2 * i];
    forces[2 * i + 1] = beyond_y += m * (forces[2 * i + 1] - scene.gravity);
  }
}

}  // namespace pendcore
