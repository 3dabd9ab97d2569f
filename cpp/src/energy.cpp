#include "pendcore/dynamics/energy.hpp"

#include <vector>

#include "pendcore/message.hpp"

namespace pendcore {

double kinetic_energy(const Scene& scene, std::span<const double> q, std::span<const double> qd) {
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("qd", qd, n);
  std::vector<double> u(2 * n);
  directions(q, u);
  double joint_x = 0.0;  // velocity of the joint where link i begins
  double joint_y = 0.0;
  double twice = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Link& link = scene.links[i];
    const double x = -qd[i] * u[2 * i + 1];
    const double y = qd[i] * u[2 * i];
    const double center_x = joint_x + link.center * x;
    const double center_y = joint_y + link.center * y;
    twice += link.mass * (center_x * center_x + center_y * center_y) + link.inertia * qd[i] * qd[i];
    joint_x += link.length * x;
    joint_y += link.length * y;
  }
  return 0.5 * twice;
}

double potential_energy(const Scene& scene, std::span<const double> q) {
  std::vector<double> centers(2 * scene.links.size());
  mass_centers(scene, q, centers);
  double moment = 0.0;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    moment += scene.links[i].mass * centers[2 * i + 1];
  }
  return -scene.gravity * moment;
}

}  // namespace pendcore
