/// \file
/// The equations of motion of a scene, in any form, as a system in memory: dy/dt of (q, qd), and
/// the powers of the ledger beside it where the run keeps one.
#pragma once

#include <memory>

#include "dynamics/energetics/ledger.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/jacobian.hpp"
#include "integrate/radau/implicit_runge_kutta.hpp"

namespace pendcore {

class SceneSystem final : public DifferentiableSystem {
 public:
  /// Rows of `row_size` numbers, of which the first belong to links.
  SceneSystem(const Scene& scene, const EquationsOfMotion& equations, int row_size,
              bool keeps_ledger);
  SceneSystem(const SceneSystem&) = delete;  // the right-hand side points into the equations
  SceneSystem& operator=(const SceneSystem&) = delete;

  void operator()(double t, const double* y, double* dydt) const override;

  /// Makes jacobian() available.
  void differentiate(const Scene& scene);
  void jacobian(double t, const double* y, double* by_q, double* by_qd) const override;
  void derivatives_of_three(const double* t, const double* y, double* dydt) const override;

 private:
  EquationsOfMotion equations_;
  RightHandSide right_hand_side_;
  int n_;
  std::unique_ptr<Ledger> ledger_;
  std::unique_ptr<Jacobian> jacobian_;
};

}  // namespace pendcore
