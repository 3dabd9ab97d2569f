#include "pendcore/equations.hpp"

#include <optional>

#include "arithmetic/floating_point_environment.hpp"
#include "dynamics/energetics/reactions.hpp"
#include "dynamics/jacobian.hpp"
#include "dynamics/joint_forces.hpp"
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
  std::shared_ptr<EffectsInForce> loads = nullptr;  ///< for reactions
};

Equations::Equations(const Scene& scene) {
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
  (*compiled_->derivatives)(t, q.data(), qd.data(), result.by_q.data(), result.by_qd.data());
  return result;
}

Points Equations::reactions(double t, const Numbers& q, const Numbers& qd) {
  const FloatingPointEnvironment ieee;
  const Vector qdd = accelerations(t, q, qd);
  if (!compiled_->loads) compiled_->loads = effects_in_force(compiled_->scene);
  Points forces(q.size(), 2);
  pendcore::reactions(compiled_->scene, *compiled_->loads, t, q.span(), qd.span(),
                      Numbers(qdd).span(), as_span(forces));
  return forces;
}

Matrix Equations::mass_matrix(const Numbers& q) {
  const FloatingPointEnvironment ieee;
  const std::size_t n = compiled_->scene.links.size();
  require_size("q", q.span(), n);
  JointForces forces(compiled_->scene);
  forces.set_mass_matrix(q.data());
  return forces.mass;
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
