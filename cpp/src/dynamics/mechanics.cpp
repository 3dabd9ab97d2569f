#include "pendcore/mechanics.hpp"

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "effects/pivot_motion.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rotor_inertia.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

using PlaneVector = Eigen::RowVector2d;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::DontAlign>;

/// u_i, a row for each link.
Columns directions(const Scene& scene, const Numbers& q) {
  require_size("q", q.span(), scene.links.size());
  Columns u(q.size(), 2);
  sine_cosine(q.data(), q.size(), u.col(1).data(), u.col(0).data());
  return u;
}

/// n_i for a row u_i.
PlaneVector across(const PlaneVector& u) { return {-u[1], u[0]}; }

}  // namespace

Points positions(const Scene& scene, double t, const Numbers& q) {
  const FloatingPointEnvironment ieee;
  const auto u = directions(scene, q);
  Points points(q.size() + 1, 2);
  points.row(0) = PlaneVector(pivot_motion(scene, t).position);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    points.row(i + 1) = points.row(i) + scene.links[i].length * u.row(i);
  }
  return points;
}

Points velocities(const Scene& scene, double t, const Numbers& q, const Numbers& qd) {
  const FloatingPointEnvironment ieee;
  const auto u = directions(scene, q);
  require_size("qd", qd.span(), scene.links.size());
  Points points(q.size() + 1, 2);
  points.row(0) = PlaneVector(pivot_motion(scene, t).velocity);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    points.row(i + 1) = points.row(i) + scene.links[i].length * qd[i] * across(u.row(i));
  }
  return points;
}

Points mass_centers(const Scene& scene, double t, const Numbers& q) {
  const FloatingPointEnvironment ieee;
  const auto u = directions(scene, q);
  Points centers(q.size(), 2);
  PlaneVector joint(pivot_motion(scene, t).position);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    centers.row(i) = joint + scene.links[i].center * u.row(i);
    joint += scene.links[i].length * u.row(i);
  }
  return centers;
}

Points mass_center_accelerations(const Scene& scene, double t, const Numbers& q, const Numbers& qd,
                                 const Numbers& qdd) {
  const FloatingPointEnvironment ieee;
  const auto u = directions(scene, q);
  require_size("qd", qd.span(), scene.links.size());
  require_size("qdd", qdd.span(), scene.links.size());
  Points accelerations(q.size(), 2);
  PlaneVector joint(pivot_motion(scene, t).acceleration);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const PlaneVector of_unit_length = qdd[i] * across(u.row(i)) - qd[i] * qd[i] * u.row(i);
    accelerations.row(i) = joint + scene.links[i].center * of_unit_length;
    joint += scene.links[i].length * of_unit_length;
  }
  return accelerations;
}

double kinetic_energy(const Scene& scene, double t, const Numbers& q, const Numbers& qd) {
  const FloatingPointEnvironment ieee;
  const auto u = directions(scene, q);
  require_size("qd", qd.span(), scene.links.size());
  PlaneVector joint(pivot_motion(scene, t).velocity);  // of the joint where link i begins
  double twice = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Link& link = scene.links[i];
    const PlaneVector of_unit_length = qd[i] * across(u.row(i));
    const PlaneVector center = joint + link.center * of_unit_length;
    twice += link.mass * center.squaredNorm() + link.inertia * qd[i] * qd[i];
    joint += link.length * of_unit_length;
  }
  for (const Payload& payload : effects_of<Payload>(scene)) {
    const double rate = qd[qd.size() - 1];
    twice += payload.mass * joint.squaredNorm();
    twice += payload.inertia * rate * rate;
  }
  for (const RotorInertia& rotor : effects_of<RotorInertia>(scene)) {
    const double phid = relative(qd.data(), rotor.joint);
    twice += rotor.armature * phid * phid;
  }
  return 0.5 * twice;
}

double potential_energy(const Scene& scene, double t, const Numbers& q) {
  const FloatingPointEnvironment ieee;
  const Points centers = mass_centers(scene, t, q);
  double moment = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) moment += scene.links[i].mass * centers(i, 1);
  if (auto payloads = effects_of<Payload>(scene); !payloads.empty()) {
    const double tip_y = positions(scene, t, q)(q.size(), 1);
    for (const Payload& payload : payloads) moment += payload.mass * tip_y;
  }
  double kept = 0.0;
  for (const Effect& effect : scene.effects) {
    const int joint = effect->joint();
    if (joint > 0) kept += effect->potential(relative(q.data(), joint));
  }
  return kept - scene.gravity * moment;
}

}  // namespace pendcore
