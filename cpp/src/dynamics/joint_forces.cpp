#include "dynamics/joint_forces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

void JointForces::set_mass_matrix(const double* q) {
  const std::size_t n = inertia.links.size();
  sine.resize(n);
  cosine.resize(n);
  mass.resize(n * n);
  sine_cosine(q, static_cast<int>(n), sine.data(), cosine.data());
  mass_matrix(inertia, sine, cosine, mass);
}

void JointForces::set_up() {
  const int n = bodies_;
  const int m = static_cast<int>(joints.size());
  factor_.assign(static_cast<std::size_t>(n) * n, 0.0);
  const double* entry = mass.data();
  for (const int row : body_) {
    for (const int column : body_) {
      if (row >= 0 && column >= 0) factor_[static_cast<std::ptrdiff_t>(row) * n + column] += *entry;
      ++entry;
    }
  }
  factor_symmetric(n, factor_.data());
  problem.resize(m);
  response_.assign(static_cast<std::size_t>(m) * n, 0.0);
  for (int r = 0; r < m; ++r) {
    if (problem.look) problem.look();
    double* const x = response_.data() + static_cast<std::ptrdiff_t>(r) * n;
    x[body_[joints[r]]] = 1.0;
    const int before = body_before(joints[r]);
    if (before >= 0) x[before] = -1.0;
    const int first = std::max(before, 0);  // those before are zero
    solve_lower(n, factor_.data(), x, first);
    for (int s = 0; s <= r; ++s) {
      const double* const y = response_.data() + static_cast<std::ptrdiff_t>(s) * n;
      double sum = 0.0;
      for (int i = first; i < n; ++i) {
        sum += x[i] * y[i] / factor_[static_cast<std::ptrdiff_t>(i) * (n + 1)];
      }
      problem.W[static_cast<std::size_t>(r) * m + s] = sum;
      problem.W[static_cast<std::size_t>(s) * m + r] = sum;
    }
  }
}

void JointForces::add_response(const std::vector<double>& lambda, double* x) const {
  std::vector<double> change(bodies_, 0.0);
  for (std::size_t r = 0; r < joints.size(); ++r) {
    const double* const row = response_.data() + static_cast<std::ptrdiff_t>(r) * bodies_;
    for (int i = 0; i < bodies_; ++i) change[i] += lambda[r] * row[i];
  }
  solve_upper(bodies_, factor_.data(), change.data());
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (body_[i] >= 0) x[i] += change[body_[i]];
  }
}

void JointForces::refined_response(double* x) {
  constexpr int most_rounds = 20;
  const std::size_t n = links.size();
  std::fill_n(x, n, 0.0);
  add_response(x);
  problem.factor_between();
  double error = never;
  for (int round = 0; round < most_rounds; ++round) {
    // By how much x and lambda miss M x = J^T lambda and J x + a = 0.
    const std::vector<TwoDouble> p = momenta(links, inertia, sine, cosine, x);
    std::vector<TwoDouble> missing(bodies_);
    for (std::size_t i = 0; i < n; ++i) {
      if (body_[i] >= 0) missing[body_[i]] = missing[body_[i]] + p[i] * -1.0;
    }
    for (std::size_t r = 0; r < joints.size(); ++r) {
      const int body = body_[joints[r]];
      const int before = body_before(joints[r]);
      missing[body] = missing[body] + problem.lambda[r];
      if (before >= 0) missing[before] = missing[before] + -problem.lambda[r];
    }
    std::vector<double> change(bodies_);
    for (int i = 0; i < bodies_; ++i) change[i] = missing[i].high;
    solve_lower(bodies_, factor_.data(), change.data());
    solve_upper(bodies_, factor_.data(), change.data());
    std::vector<double> more(n);
    for (std::size_t i = 0; i < n; ++i) more[i] = body_[i] >= 0 ? change[body_[i]] : 0.0;
    std::vector<double> slip(joints.size());
    for (std::size_t r = 0; r < joints.size(); ++r) {
      const int joint = joints[r] + 1;
      slip[r] = (problem.a[r] + relative(x, joint)) + relative(more.data(), joint);
    }
    const std::vector<double> torques = problem.forces_against(slip);
    add_response(torques, more.data());
    // The energy of the correction falls until rounding alone is left.
    double energy = 0.0;
    for (int i = 0; i < bodies_; ++i) energy += std::abs(missing[i].high * change[i]);
    for (std::size_t r = 0; r < joints.size(); ++r) energy += std::abs(torques[r] * slip[r]);
    if (!(energy < 0.25 * error)) return;
    error = energy;
    for (std::size_t i = 0; i < n; ++i) x[i] += more[i];
    for (std::size_t r = 0; r < joints.size(); ++r) problem.lambda[r] += torques[r];
  }
}

}  // namespace pendcore
