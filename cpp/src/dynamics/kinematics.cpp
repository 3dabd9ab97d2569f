#include "dynamics/kinematics.hpp"

#include <algorithm>
#include <vector>

#include "arithmetic/sine_cosine.hpp"
#include "effects/pivot_motion.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

std::vector<double> directions_of(std::span<const double> q) {
  std::vector<double> u(2 * q.size());
  directions(q, u);
  return u;
}

}  // namespace

void directions(std::span<const double> q, std::span<double> u) {
  require_size("u", u, 2 * q.size());
  constexpr std::size_t at_once = 32;
  double sine[at_once], cosine[at_once];
  for (std::size_t first = 0; first < q.size(); first += at_once) {
    const std::size_t count = std::min(at_once, q.size() - first);
    sine_cosine(q.data() + first, static_cast<long long>(count), sine, cosine);
    for (std::size_t i = 0; i < count; ++i) {
      u[2 * (first + i)] = cosine[i];
      u[2 * (first + i) + 1] = sine[i];
    }
  }
}

void positions(const Scene& scene, double t, std::span<const double> q, std::span<double> points) {
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("points", points, 2 * (n + 1));
  const std::vector<double> u = directions_of(q);
  const PivotMotion pivot = pivot_motion(scene, t);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double joint = points[axis] = pivot.position[axis];
    for (std::size_t i = 0; i < n; ++i) {
      joint += scene.links[i].length * u[2 * i + axis];
      points[2 * (i + 1) + axis] = joint;
    }
  }
}

void mass_centers(const Scene& scene, double t, std::span<const double> q,
                  std::span<double> points) {
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("points", points, 2 * n);
  const std::vector<double> u = directions_of(q);
  const PivotMotion pivot = pivot_motion(scene, t);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    double joint = pivot.position[axis];
    for (std::size_t i = 0; i < n; ++i) {
      points[2 * i + axis] = joint + scene.links[i].center * u[2 * i + axis];
      joint += scene.links[i].length * u[2 * i + axis];
    }
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
  const std::vector<double> u = directions_of(q);
  const PivotMotion pivot = pivot_motion(scene, t);
  double joint[2] = {pivot.acceleration[0], pivot.acceleration[1]};
  for (std::size_t i = 0; i < n; ++i) {
    const double across[2] = {-u[2 * i + 1], u[2 * i]};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double unit = qdd[i] * across[axis] - qd[i] * qd[i] * u[2 * i + axis];
      accelerations[2 * i + axis] = joint[axis] + scene.links[i].center * unit;
      joint[axis] += scene.links[i].length * unit;
    }
  }
}

}  // namespace pendcore
