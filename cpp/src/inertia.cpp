#include "pendcore/dynamics/inertia.hpp"

#include <algorithm>

#include "pendcore/dynamics/kinematics.hpp"

namespace pendcore {

Inertia::Inertia(const Scene& scene) {
  const std::size_t n = scene.links.size();
  carried.resize(n);
  first_moment.resize(n);
  diagonal.resize(n);
  length.resize(n);
  double beyond = 0.0;
  for (std::size_t i = n; i-- > 0;) {
    const Link& link = scene.links[i];
    carried[i] = beyond;
    length[i] = link.length;
    first_moment[i] = link.mass * link.center + link.length * beyond;
    diagonal[i] =
        link.inertia + link.mass * link.center * link.center + link.length * link.length * beyond;
    beyond += link.mass;
  }
}

double Inertia::coupling(std::size_t i, std::size_t j) const {
  return i == j ? diagonal[i] : length[std::min(i, j)] * first_moment[std::max(i, j)];
}

Eigen::MatrixXd mass_matrix(const Inertia& inertia, const Eigen::Ref<const Eigen::VectorXd>& q) {
  const Points u = directions(q);
  Eigen::MatrixXd matrix = u * u.transpose();  // cos(q_i - q_j)
  const std::size_t n = inertia.diagonal.size();
  for (std::size_t i = 0; i < n; ++i) {
    matrix(i, i) = inertia.diagonal[i];
    for (std::size_t j = 0; j < i; ++j) {
      matrix(i, j) = matrix(j, i) = inertia.coupling(i, j) * matrix(i, j);
    }
  }
  return matrix;
}

}  // namespace pendcore
