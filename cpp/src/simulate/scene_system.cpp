#include "pendcore/simulate/scene_system.hpp"

namespace pendcore {

SceneSystem::SceneSystem(const Scene& scene, const EquationsOfMotion& equations, int row_size,
                         bool keeps_ledger)
    : DifferentiableSystem(row_size,
                           keeps_ledger ? static_cast<int>(accounts_of(scene).size()) : 0),
      equations_(equations),
      right_hand_side_(right_hand_side(equations_)),
      n_(static_cast<int>(scene.links.size())) {
  if (quadratures > 0) ledger_ = std::make_unique<Ledger>(scene, equations.effects);
}

void SceneSystem::operator()(double t, const double* y, double* dydt) const {
  for (int i = 0; i < n_; ++i) dydt[i] = y[row + i];
  right_hand_side_(t, y, y + row, dydt + row);
  if (ledger_) {
    ledger_->powers(t, y, y + row, dydt + row, dydt + static_cast<std::ptrdiff_t>(2) * row);
  }
}

bool SceneSystem::derivatives_of_three(const double* t, const double* y, double* dydt) const {
  // The kernel knows states of two links, and nothing beside them.
  if (right_hand_side_.three == nullptr || row != 2 || quadratures > 0) return false;
  right_hand_side_.three(right_hand_side_.form, t, y, dydt);
  return true;
}

void SceneSystem::differentiate(const Scene& scene) {
  jacobian_ = std::make_unique<Jacobian>(scene, equations_);
}

void SceneSystem::jacobian(double t, const double* y, double* by_q, double* by_qd) const {
  (*jacobian_)(t, y, y + row, by_q, by_qd);
}

}  // namespace pendcore
