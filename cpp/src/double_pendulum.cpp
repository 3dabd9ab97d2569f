#include "pendcore/dynamics/double_pendulum.hpp"

namespace pendcore {

DoublePendulum::DoublePendulum(const Scene& scene, const Inertia& inertia) {
  const Link& first = scene.links[0];
  const Link& second = scene.links[1];
  for (int i = 0; i < 2; ++i) {
    weight[i] = inertia.first_moment[i] * scene.gravity / inertia.diagonal[i];
    coupling[i] = inertia.coupling(0, 1) / inertia.diagonal[i];
  }
  product = coupling[0] * coupling[1];
  // A_11 A_22 - A_12^2 = (I_1 + m_1 c_1^2) A_22 + L_1^2 m_2 I_2: no difference is taken
  const double hung = first.length * first.length * second.mass;
  delta = first.inertia_about_joint() / inertia.diagonal[0] +
          (hung / inertia.diagonal[0]) * (second.inertia / inertia.diagonal[1]);
}

}  // namespace pendcore
