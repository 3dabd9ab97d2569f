#include "pendcore/equations.hpp"

#include "arithmetic/floating_point_environment.hpp"
#include "dynamics/compiled_equations.hpp"
#include "dynamics/inverse_dynamics.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"

namespace pendcore {

Equations::Equations(const Scene& scene) {
  const FloatingPointEnvironment ieee;
  check(scene);
  compiled_ = std::make_unique<Compiled>(scene);
}
Equations::~Equations() = default;
Equations::Equations(Equations&& other) noexcept = default;
Equations& Equations::operator=(Equations&& other) noexcept = default;

void Equations::accelerations(double t, const Numbers& q, const Numbers& qd,
                              Eigen::Ref<Vector> qdd) {
  const FloatingPointEnvironment ieee;
  compiled_->require_state(q, qd);
  require_size("qdd", {qdd.data(), static_cast<std::size_t>(qdd.size())}, q.span().size());
  pendcore::accelerations(compiled_->equations, t, q.data(), qd.data(), qdd.data());
}

Vector Equations::accelerations(double t, const Numbers& q, const Numbers& qd) {
  Vector qdd(q.size());
  accelerations(t, q, qd, qdd);
  return qdd;
}

Derivatives Equations::jacobian(double t, const Numbers& q, const Numbers& qd) {
  const FloatingPointEnvironment ieee;
  compiled_->require_state(q, qd);
  const EquationsOfMotion& equations = compiled_->equations;
  if (!compiled_->derivatives) compiled_->derivatives.emplace(compiled_->scene, equations);
  if (equations.effects) choose_modes(*equations.effects, t, q.data(), qd.data(), true);
  Derivatives result{.by_q = Matrix(q.size(), q.size()), .by_qd = Matrix(q.size(), q.size())};
  (*compiled_->derivatives)(t, q.data(), qd.data(), result.by_q, result.by_qd);
  return result;
}

Points Equations::reactions(double t, const Numbers& q, const Numbers& qd) {
  const FloatingPointEnvironment ieee;
  const Vector qdd = accelerations(t, q, qd);
  const std::vector<int> modes = modes_at(compiled_->scene, t, q.data(), qd.data());
  const auto& found = compiled_->motion(modes, t, q, qd, qdd).forces();
  Points forces(q.size(), 2);
  for (Eigen::Index i = 0; i < q.size(); ++i) forces.row(i) << found[i].x, found[i].y;
  return forces;
}

Vector Equations::inverse_dynamics(double t, const Numbers& q, const Numbers& qd,
                                   const Numbers& qdd) {
  const FloatingPointEnvironment ieee;
  compiled_->require_state(q, qd);
  require_size("qdd", qdd.span(), q.span().size());
  const Scene& scene = compiled_->scene;
  std::vector<int> modes = modes_at(scene, t, q.data(), qd.data());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    const bool can_stick = effect.holding_torque().has_value();
    if (can_stick && relative(qd.data(), effect.joint()) == 0.0) modes[i] = 0;
  }
  const auto& found = compiled_->motion(modes, t, q, qd, qdd).torques();
  Vector torques = View(found.data(), q.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const std::optional<UserLaw> user = scene.effects[i]->user_law(modes[i]);
    if (!user) continue;
    Vector of_links = Vector::Zero(q.size());
    (*user)(t, static_cast<int>(q.size()), q.data(), qd.data(), of_links.data());
    double beyond = 0.0;
    for (Eigen::Index k = q.size(); k-- > 0;) torques[k] -= beyond += of_links[k];
  }
  return torques;
}

Matrix Equations::mass_matrix(const Numbers& q) {
  const FloatingPointEnvironment ieee;
  require_size("q", q.span(), compiled_->scene.links.size());
  if (!compiled_->joint_forces) compiled_->joint_forces.emplace(compiled_->scene);
  compiled_->joint_forces->set_mass_matrix(q.data());
  return compiled_->joint_forces->mass;
}

Vector accelerations(const Scene& scene, double t, const Numbers& q, const Numbers& qd) {
  return Equations(scene).accelerations(t, q, qd);
}
Derivatives jacobian(const Scene& scene, double t, const Numbers& q, const Numbers& qd) {
  return Equations(scene).jacobian(t, q, qd);
}
Points reactions(const Scene& scene, double t, const Numbers& q, const Numbers& qd) {
  return Equations(scene).reactions(t, q, qd);
}
Matrix mass_matrix(const Scene& scene, const Numbers& q) { return Equations(scene).mass_matrix(q); }

}  // namespace pendcore
