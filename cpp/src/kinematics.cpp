#include "pendcore/dynamics/kinematics.hpp"

#include "pendcore/arithmetic/sine_cosine.hpp"

namespace pendcore {

Points directions(Values q) {
  Eigen::VectorXd sine(q.size());
  Eigen::VectorXd cosine(q.size());
  sine_cosine(q.data(), q.size(), sine.data(), cosine.data());
  Points u(q.size(), 2);
  u.col(0) = cosine;
  u.col(1) = sine;
  return u;
}

void positions(const Scene& scene, Values q, PointsOut points) {
  const Points u = directions(q);
  points.row(0).setZero();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    points.row(i + 1) = points.row(i) + scene.links[i].length * u.row(i);
  }
}

void mass_centers(const Scene& scene, Values q, PointsOut points) {
  const Points u = directions(q);
  Eigen::RowVector2d joint = Eigen::RowVector2d::Zero();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    points.row(i) = joint + scene.links[i].center * u.row(i);
    joint += scene.links[i].length * u.row(i);
  }
}

void mass_center_accelerations(const Scene& scene, Values q, Values qd, Values qdd,
                               PointsOut accelerations) {
  const Points u = directions(q);
  Eigen::RowVector2d joint = Eigen::RowVector2d::Zero();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Eigen::RowVector2d across(-u(i, 1), u(i, 0));
    const Eigen::RowVector2d unit = qdd(i) * across - qd(i) * qd(i) * u.row(i);
    accelerations.row(i) = joint + scene.links[i].center * unit;
    joint += scene.links[i].length * unit;
  }
}

}  // namespace pendcore
