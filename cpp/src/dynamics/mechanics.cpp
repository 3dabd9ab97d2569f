#include "pendcore/mechanics.hpp"

#include <vector>

#include "dynamics/kinematics.hpp"

#include "effects/behaviour.hpp"
#include "effects/pivot_motion.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rotor_inertia.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {

Points positions(const Scene& scene, double t, const Numbers& q) {
  Points points(scene.links.size() + 1, 2);
  positions(scene, t, q.span(), as_span(points));
  return points;
}

Points mass_centers(const Scene& scene, double t, const Numbers& q) {
  Points centers(scene.links.size(), 2);
  mass_centers(scene, t, q.span(), as_span(centers));
  return centers;
}

Points mass_center_accelerations(const Scene& scene, double t, const Numbers& q, const Numbers& qd,
                                 const Numbers& qdd) {
  Points accelerations(scene.links.size(), 2);
  mass_center_accelerations(scene, t, q.span(), qd.span(), qdd.span(), as_span(accelerations));
  return accelerations;
}

double kinetic_energy(const Scene& scene, double t, const Numbers& angles, const Numbers& rates) {
  const std::span q = angles.span();
  const std::span qd = rates.span();
  const std::size_t n = scene.links.size();
  require_size("q", q, n);
  require_size("qd", qd, n);
  std::vector<double> u(2 * n);
  directions(q, u);
  const PivotMotion pivot = pivot_motion(scene, t);
  double joint_x = pivot.velocity[0];  // velocity of the joint where link i begins
  double joint_y = pivot.velocity[1];
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
  for (const Payload& payload : effects_of<Payload>(scene)) {
    twice += payload.mass * (joint_x * joint_x + joint_y * joint_y);
    twice += payload.inertia * qd[n - 1] * qd[n - 1];
  }
  for (const RotorInertia& rotor : effects_of<RotorInertia>(scene)) {
    const double phid = relative(qd.data(), rotor.joint);
    twice += rotor.armature * phid * phid;
  }
  return 0.5 * twice;
}

double potential_energy(const Scene& scene, double t, const Numbers& angles) {
  const std::span q = angles.span();
  const std::size_t n = scene.links.size();
  std::vector<double> centers(2 * n);
  mass_centers(scene, t, q, centers);
  double moment = 0.0;
  for (std::size_t i = 0; i < n; ++i) moment += scene.links[i].mass * centers[2 * i + 1];
  if (auto payloads = effects_of<Payload>(scene); !payloads.empty()) {
    std::vector<double> joints(2 * n + 2);
    positions(scene, t, q, joints);
    for (const Payload& payload : payloads) moment += payload.mass * joints.back();
  }
  double kept = 0.0;
  for (const Effect& effect : scene.effects) {
    const int joint = effect->joint();
    if (joint > 0) kept += effect->potential(relative(q.data(), joint));
  }
  return kept - scene.gravity * moment;
}

}  // namespace pendcore
