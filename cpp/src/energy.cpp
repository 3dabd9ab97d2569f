#include "pendcore/dynamics/energy.hpp"

namespace pendcore {

double kinetic_energy(const Scene& scene, Values q, Values qd) {
  const Points u = directions(q);
  Eigen::RowVector2d joint = Eigen::RowVector2d::Zero();
  double twice = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Link& link = scene.links[i];
    const Eigen::RowVector2d unit = qd(i) * Eigen::RowVector2d(-u(i, 1), u(i, 0));
    const Eigen::RowVector2d center = joint + link.center * unit;
    twice += link.mass * center.squaredNorm() + link.inertia * qd(i) * qd(i);
    joint += link.length * unit;
  }
  return 0.5 * twice;
}

double potential_energy(const Scene& scene, Values q) {
  Points centers(q.size(), 2);
  mass_centers(scene, q, centers);
  double moment = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) moment += scene.links[i].mass * centers(i, 1);
  return -scene.gravity * moment;
}

}  // namespace pendcore
