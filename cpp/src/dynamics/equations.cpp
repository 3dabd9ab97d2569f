#include "pendcore/equations.hpp"

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/compiled_equations.hpp"
#include "dynamics/energetics/ledger.hpp"
#include "dynamics/inverse_dynamics.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/mechanics.hpp"

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
  using PlaneVector = Eigen::RowVector2d;
  const Scene& scene = compiled_->scene;
  const Vector qdd = accelerations(t, q, qd);
  if (!compiled_->loads) compiled_->loads = effects_of_run(scene);
  EffectsOfRun& effects = *compiled_->loads;
  if (effects.has_modes) choose_modes(effects, t, q.data(), qd.data(), true);
  Points loads(q.size(), 2);
  effect_forces(scene, effects, t, q.data(), qd.data(),
                {loads.data(), static_cast<std::size_t>(loads.size())});

  const PlaneVector gravity(0.0, scene.gravity);
  Points forces = mass_center_accelerations(scene, t, q, qd, qdd);
  PlaneVector beyond(0.0, 0.0);  // F_{i,i+1}
  for (const Payload& payload : effects_of<Payload>(scene)) {
    // a_tip = a_C + (L - c)(qdd n - qd^2 u)
    const Eigen::Index i = q.size() - 1;
    const double rest = scene.links[i].length - scene.links[i].center;
    double s, c;
    sine_cosine(q.data() + i, 1, &s, &c);
    const PlaneVector of_unit_length =
        qdd[i] * PlaneVector(-s, c) - qd[i] * qd[i] * PlaneVector(c, s);
    beyond += payload.mass * (forces.row(i) + rest * of_unit_length - gravity);
  }
  for (Eigen::Index i = q.size(); i-- > 0;) {
    beyond += scene.links[i].mass * (forces.row(i) - gravity) - loads.row(i);
    forces.row(i) = beyond;
  }
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
  const std::vector<double> all =
      InverseDynamics<double>().torques(mechanism(scene, modes), t, q, qd, qdd);
  Vector torques = View(all.data(), q.size());
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
