#include "simulate/scene_system.hpp"

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

void SceneSystem::derivatives_of_three(const double* t, const double* y, double* dydt) const {
  // The kernel knows states of two links, and nothing beside them.
  const bool has_kernel = right_hand_side_.compute_three != nullptr && row == 2 && quadratures == 0;
  if (!has_kernel) return DifferentiableSystem::derivatives_of_three(t, y, dydt);
  right_hand_side_.compute_three(right_hand_side_.form, t, y, dydt);
}

void SceneSystem::differentiate(const Scene& scene) {
  jacobian_ = std::make_unique<Jacobian>(scene, equations_);
}

void SceneSystem::jacobian(double t, const double* y, double* by_q, double* by_qd) const {
  (*jacobian_)(t, y, y + row, by_q, by_qd);
}

}  // namespace pendcore
