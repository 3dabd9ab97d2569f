#include "pendcore/dynamics/inertia.hpp"

#include <algorithm>

#include "pendcore/dynamics/kinematics.hpp"
#include "pendcore/text/message.hpp"

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

void mass_matrix(const Inertia& inertia, std::span<const double> sine,
                 std::span<const double> cosine, std::span<double> matrix) {
  const std::size_t n = inertia.diagonal.size();
  require_size("sine", sine, n);
  require_size("cosine", cosine, n);
  require_size("matrix", matrix, n * n);
  for (std::size_t i = 0; i < n; ++i) {
    matrix[i * n + i] = inertia.diagonal[i];
    for (std::size_t j = 0; j < i; ++j) {
      const double of_difference = cosine[i] * cosine[j] + sine[i] * sine[j];
      const double of_rotor = j + 1 == i ? inertia.rotor[i] : 0.0;
      matrix[i * n + j] = matrix[j * n + i] = inertia.coupling(i, j) * of_difference - of_rotor;
    }
  }
}

}  // namespace pendcore
