#include "pendcore/dynamics/reactions.hpp"

namespace pendcore {

void reactions(const Scene& scene, Values q, Values qd, Values qdd, PointsOut forces) {
  mass_center_accelerations(scene, q, qd, qdd, forces);
  const Eigen::RowVector2d gravity(0.0, scene.gravity);
  Eigen::RowVector2d from_beyond = Eigen::RowVector2d::Zero();
  for (Eigen::Index i = q.size(); i-- > 0;) {
    forces.row(i) = scene.links[i].mass * (forces.row(i) - gravity) + from_beyond;
    from_beyond = forces.row(i);
  }
}

}  // namespace pendcore
