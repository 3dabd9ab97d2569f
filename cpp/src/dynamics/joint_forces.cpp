#include "pendcore/dynamics/joint_forces.hpp"

#include <algorithm>
#include <cstddef>

#include "pendcore/arithmetic/sine_cosine.hpp"

namespace pendcore {

void JointForces::set_mass_matrix(const double* q) {
  const std::size_t n = inertia.links.size();
  sine.resize(n);
  cosine.resize(n);
  mass.resize(n * n);
  sine_cosine(q, static_cast<int>(n), sine.data(), cosine.data());
  mass_matrix(inertia, sine, cosine, mass);
}

void JointForces::set_up() {
  const int n = static_cast<int>(inertia.links.size());
  const int m = static_cast<int>(joints.size());
  factor_ = mass;
  factor_symmetric(n, factor_.data());
  problem.resize(m);
  response_.assign(joints.size() * inertia.links.size(), 0.0);
  for (int r = 0; r < m; ++r) {
    if (problem.look) problem.look();
    double* const x = response_.data() + static_cast<std::ptrdiff_t>(r) * n;
    x[joints[r]] = 1.0;
    if (joints[r] > 0) x[joints[r] - 1] = -1.0;
    const int first = std::max(joints[r] - 1, 0);  // those before are zero
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

void JointForces::add_response(double* x) const {
  const int n = static_cast<int>(inertia.links.size());
  std::vector<double> change(inertia.links.size(), 0.0);
  for (std::size_t r = 0; r < joints.size(); ++r) {
    const double* const row = response_.data() + r * inertia.links.size();
    for (int i = 0; i < n; ++i) change[i] += problem.lambda[r] * row[i];
  }
  solve_upper(n, factor_.data(), change.data());
  for (int i = 0; i < n; ++i) x[i] += change[i];
}

}  // namespace pendcore
