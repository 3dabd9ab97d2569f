#include "dynamics/closed_form/double_pendulum.hpp"

namespace pendcore {

DoublePendulum::DoublePendulum(const Scene& scene, const Inertia& inertia) {
  const Link& first = scene.links[0];
  const Link& second = scene.links[1];
  for (int i = 0; i < 2; ++i) {
    weight[i] = inertia.links[i].first_moment * scene.gravity / inertia.links[i].divisor();
    coupling[i] = inertia.coupling(0, 1) / inertia.links[i].divisor();
  }
  product = coupling[0] * coupling[1];
  // A_11 A_22 - A_12^2 = (I_1 + m_1 c_1^2) A_22 + L_1^2 m_2 I_2, and with a payload
  // L_1^2 ((m_2 + m_p)(I_2 + I_p) + m_2 m_p (L_2 - c_2)^2) at its end: all terms are positive.
  const double about_joint = first.inertia_about_joint() + inertia.links[0].rotor;
  const double hung = first.length * first.length * (second.mass + inertia.payload_mass);
  const double apart = second.length - second.center;
  double about_center = second.inertia + inertia.payload_inertia;
  if (inertia.payload_mass > 0.0) {
    const double share = inertia.payload_mass / (second.mass + inertia.payload_mass);
    about_center += second.mass * share * apart * apart;
  }
  delta = about_joint / inertia.links[0].divisor() +
          (hung / inertia.links[0].divisor()) * (about_center / inertia.links[1].divisor());
}

}  // namespace pendcore
