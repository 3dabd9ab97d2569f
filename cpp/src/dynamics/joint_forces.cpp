#include "dynamics/joint_forces.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/sine_cosine.hpp"
#include "dynamics/contact/momenta.hpp"
#include "dynamics/kinematics.hpp"

namespace pendcore {

JointForces::JointForces(const Scene& scene, const std::vector<bool>& rigid)
    : links(scene.links), inertia(scene) {
  int body = -1;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (rigid.empty() || !rigid[i]) ++body;
    body_.push_back(body);
  }
  bodies_ = body + 1;
}

JointForces JointForces::on_free_joints(const Scene& scene, const std::vector<bool>& held) {
  JointForces forces(scene, held);
  for (std::size_t j = 0; j < held.size(); ++j) {
    if (!held[j]) forces.joints.push_back(static_cast<int>(j));
  }
  return forces;
}

void JointForces::set_mass_matrix(const double* q) {
  const std::size_t n = inertia.links.size();
  sine.resize(n);
  cosine.resize(n);
  sine_cosine(q, static_cast<int>(n), sine.data(), cosine.data());
  mass.resize(n, n);
  for (std::size_t i = 0; i < n; ++i) {
    mass(i, i) = inertia.links[i].diagonal;
    for (std::size_t j = 0; j < i; ++j) {
      const double of_difference = cosine[i] * cosine[j] + sine[i] * sine[j];
      const double of_rotor = j + 1 == i ? inertia.links[i].rotor : 0.0;
      mass(i, j) = mass(j, i) = inertia.coupling(i, j) * of_difference - of_rotor;
    }
  }
}

void JointForces::factor_mass() {
  factor_.setZero(bodies_, bodies_);
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (body_[i] >= 0 && body_[k] >= 0) factor_(body_[i], body_[k]) += mass(i, k);
    }
  }
  factor_symmetric(factor_);
}

void JointForces::respond(const double* lambda, double* change) {
  bodies_change_.setZero(bodies_);
  for (std::size_t r = 0; r < joints.size(); ++r) {
    bodies_change_(body_[joints[r]]) += lambda[r];
    const int before = body_before(joints[r]);
    if (before >= 0) bodies_change_(before) -= lambda[r];
  }
  solve_lower(factor_, bodies_change_);
  solve_upper(factor_, bodies_change_);
  for (std::size_t i = 0; i < links.size(); ++i) {
    change[i] = body_[i] >= 0 ? bodies_change_(body_[i]) : 0.0;
  }
}

void JointForces::set_up() {
  const int m = static_cast<int>(joints.size());
  factor_mass();
  problem.resize(m);
  response_.setZero(m, bodies_);
  for (int r = 0; r < m; ++r) {
    if (problem.look) problem.look();
    auto x = response_.row(r).transpose();
    x(body_[joints[r]]) = 1.0;
    const int before = body_before(joints[r]);
    if (before >= 0) x(before) = -1.0;
    const int first = std::max(before, 0);  // those before are zero
    solve_lower(factor_, x, first);
    for (int s = 0; s <= r; ++s) {
      double sum = 0.0;
      for (int i = first; i < bodies_; ++i) sum += x(i) * response_(s, i) / factor_(i, i);
      problem.W(r, s) = problem.W(s, r) = sum;
    }
  }
}

Vector JointForces::of_links(const Vector& bodies) const {
  Vector each(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) each(i) = body_[i] >= 0 ? bodies(body_[i]) : 0.0;
  return each;
}

Vector JointForces::response(const Vector& lambda) const {
  Vector change = Vector::Zero(bodies_);
  for (Eigen::Index r = 0; r < lambda.size(); ++r) {
    change += lambda(r) * response_.row(r).transpose();
  }
  solve_upper(factor_, change);
  return of_links(change);
}

Vector JointForces::refined_response() {
  constexpr int most_rounds = 20;
  const std::size_t n = links.size();
  Vector x = Vector::Zero(links.size());
  x += response();  // and no zero of it is negative
  problem.factor_between();
  double error = never;
  for (int round = 0; round < most_rounds; ++round) {
    // By how much x and lambda miss M x = J^T lambda and J x + a = 0.
    const std::vector<TwoDouble> p = momenta(links, inertia, sine, cosine, x.data());
    std::vector<TwoDouble> missing(bodies_);
    for (std::size_t i = 0; i < n; ++i) {
      if (body_[i] >= 0) missing[body_[i]] = missing[body_[i]] + p[i] * -1.0;
    }
    for (std::size_t r = 0; r < joints.size(); ++r) {
      const int body = body_[joints[r]];
      const int before = body_before(joints[r]);
      missing[body] = missing[body] + problem.lambda(r);
      if (before >= 0) missing[before] = missing[before] + -problem.lambda(r);
    }
    Vector change(bodies_);
    for (int i = 0; i < bodies_; ++i) change(i) = missing[i].high;
    solve_lower(factor_, change);
    solve_upper(factor_, change);
    Vector more = of_links(change);
    Vector slip(joints.size());
    for (std::size_t r = 0; r < joints.size(); ++r) {
      const int joint = joints[r] + 1;
      slip(r) = (problem.a(r) + relative(x.data(), joint)) + relative(more.data(), joint);
    }
    const Vector torques = problem.forces_against(slip);
    more += response(torques);
    // The energy of the correction falls until rounding alone is left.
    double energy = 0.0;
    for (int i = 0; i < bodies_; ++i) energy += std::abs(missing[i].high * change(i));
    for (Eigen::Index r = 0; r < slip.size(); ++r) energy += std::abs(torques(r) * slip(r));
    if (!(energy < 0.25 * error)) return x;
    error = energy;
    x += more;
    problem.lambda += torques;
  }
  return x;
}

}  // namespace pendcore
