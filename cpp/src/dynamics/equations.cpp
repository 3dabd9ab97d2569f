#include "pendcore/equations.hpp"

#include <optional>

#include "arithmetic/floating_point_environment.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/energetics/ledger.hpp"
#include "dynamics/jacobian.hpp"
#include "dynamics/joint_forces.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/mechanics.hpp"
#include "scene/effects_of_scene.hpp"
#include "text/message.hpp"

namespace pendcore {

struct Equations::Compiled {
  explicit Compiled(const Scene& given) : scene(given), equations(equations_of_motion(given)) {}

  void require_state(const Numbers& q, const Numbers& qd) const {
    require_size("q", q.span(), scene.links.size());
    require_size("qd", qd.span(), scene.links.size());
  }

  Scene scene;
  EquationsOfMotion equations;
  std::optional<Jacobian> derivatives{};
  std::shared_ptr<EffectsOfRun> loads = nullptr;  ///< for reactions
  std::optional<JointForces> joint_forces{};      ///< for the mass matrix
};

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
