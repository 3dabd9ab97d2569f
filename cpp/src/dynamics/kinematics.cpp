#include "pendcore/dynamics/kinematics.hpp"

#include <Eigen/Core>

#include "pendcore/arithmetic/sine_cosine.hpp"
#include "pendcore/text/message.hpp"

namespace pendcore {
namespace {

using Eigen::RowVector2d;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

Eigen::Map<Rows> rows(std::span<double> points) {
  return {points.data(), static_cast<Eigen::Index>(points.size() / 2), 2};
}

Rows directions_of(std::span<const double> q) {
  Rows u(q.size(), 2);
  directions(q, {u.data(), 2 * q.size()});
  return u;
}

}  // namespace

void directions(std::span<const double> q, std::span<double> u) {
  require_size("u", u, 2 * q.size());
  Eigen::ArrayXd sine(q.size());
  Eigen::ArrayXd cosine(q.size());
  sine_cosine(q.data(), static_cast<long long>(q.size()), sine.data(), cosine.data());
  rows(u).col(0) = cosine;
  rows(u).col(1) = sine;
}

void positions(const Scene& scene, double t, std::span<const double> q, std::span<double> points) {
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("points", points, 2 * (n + 1));
  const Rows u = directions_of(q);
  Eigen::Map<Rows> joints = rows(points);
  const PivotMotion pivot = pivot_motion(scene, t);
  joints.row(0) << pivot.position[0], pivot.position[1];
  for (std::size_t i = 0; i < n; ++i) {
    joints.row(i + 1) = joints.row(i) + scene.links[i].length * u.row(i);
  }
}

void mass_centers(const Scene& scene, double t, std::span<const double> q,
                  std::span<double> points) {
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("points", points, 2 * n);
  const Rows u = directions_of(q);
  const PivotMotion pivot = pivot_motion(scene, t);
  RowVector2d joint(pivot.position[0], pivot.position[1]);
  for (std::size_t i = 0; i < n; ++i) {
    rows(points).row(i) = joint + scene.links[i].center * u.row(i);
    joint += scene.links[i].length * u.row(i);
  }
}

void mass_center_accelerations(const Scene& scene, double t, std::span<const double> q,
                               std::span<const double> qd, std::span<const double> qdd,
                               std::span<double> accelerations) {
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("qd", qd, n);
  require_size("qdd", qdd, n);
  require_size("accelerations", accelerations, 2 * n);
  const Rows u = directions_of(q);
  const PivotMotion pivot = pivot_motion(scene, t);
  RowVector2d joint(pivot.acceleration[0], pivot.acceleration[1]);
  for (std::size_t i = 0; i < n; ++i) {
    const RowVector2d across(-u(i, 1), u(i, 0));
    const RowVector2d unit = qdd[i] * across - qd[i] * qd[i] * u.row(i);
    rows(accelerations).row(i) = joint + scene.links[i].center * unit;
    joint += scene.links[i].length * unit;
  }
}

}  // namespace pendcore
