#include "pendcore/dynamics/inertia.hpp"

#include <algorithm>
#include <Eigen/Core>

#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/message.hpp"

namespace pendcore {

Inertia::Inertia(const Scene& scene) {
  const std::size_t n = scene.links.size();
  first_moment.resize(n);
  diagonal.resize(n);
  length.resize(n);
  rotor.assign(n, 0.0);
  for (const Payload& payload : effects_of<Payload>(scene)) {
    payload_mass += payload.mass;
    payload_inertia += payload.inertia;
  }
  for (const RotorInertia& one : effects_of<RotorInertia>(scene)) {
    rotor[one.joint - 1] += one.armature;
  }
  double beyond = payload_mass;  // S_i
  for (std::size_t i = n; i-- > 0;) {
    const Link& link = scene.links[i];
    length[i] = link.length;
    first_moment[i] = link.mass * link.center + link.length * beyond;
    diagonal[i] = link.inertia_about_joint() + link.length * link.length * beyond;
    beyond += link.mass;
    if (i + 1 == n) diagonal[i] += payload_inertia;
    diagonal[i] += rotor[i] + (i + 1 < n ? rotor[i + 1] : 0.0);
  }
}

double Inertia::coupling(std::size_t i, std::size_t j) const {
  return length[std::min(i, j)] * first_moment[std::max(i, j)];
}

void mass_matrix(const Inertia& inertia, std::span<const double> q, std::span<double> matrix) {
  const std::size_t n = inertia.diagonal.size();
  require_size("q", q, n);
  require_size("matrix", matrix, n * n);
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> u(n, 2);
  directions(q, {u.data(), 2 * n});
  Eigen::Map<Eigen::MatrixXd> a(matrix.data(), n, n);
  a = u * u.transpose();  // cos(q_i - q_j)
  for (std::size_t i = 0; i < n; ++i) {
    a(i, i) = inertia.diagonal[i];
    for (std::size_t j = 0; j < i; ++j) {
      const double of_rotor = j + 1 == i ? inertia.rotor[i] : 0.0;
      a(i, j) = a(j, i) = inertia.coupling(i, j) * a(i, j) - of_rotor;
    }
  }
}

}  // namespace pendcore
