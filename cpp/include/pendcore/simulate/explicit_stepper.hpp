/// \file
/// The stepper of one method for a scene: which form of the equations meets which stepper.
///
/// A method that the list has needs nothing here. Those that take long to compile are instantiated
/// in a source of their own, and named at the end of this file.
#pragma once

#include <memory>

#include "pendcore/dynamics/first_order.hpp"
#include "pendcore/integrate/runge_kutta/dormand_prince_5.hpp"
#include "pendcore/integrate/runge_kutta/dormand_prince_8.hpp"
#include "pendcore/integrate/runge_kutta/runge_kutta_dynamic.hpp"
#include "pendcore/integrate/runge_kutta/runge_kutta_fixed.hpp"
#include "pendcore/simulate/scene_system.hpp"

namespace pendcore {

template <const auto& table, class Block, bool compensated>
std::unique_ptr<Stepper> dynamic_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                         bool keeps_ledger) {
  constexpr int width = Lanes<Block>::width;
  const int n = static_cast<int>(scene.links.size());
  const int row = (n + width - 1) / width * width;
  return std::make_unique<RungeKuttaDynamic<table, Block, compensated>>(
      std::make_unique<SceneSystem>(scene, equations, row, keeps_ledger), n);
}

/// Runs that verify others are compensated: few links are worth packs of their own width.
template <const auto& table>
std::unique_ptr<Stepper> compensated_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                             bool keeps_ledger) {
  switch (scene.links.size()) {
    case 1: return dynamic_stepper<table, double, true>(scene, equations, keeps_ledger);
    case 2: return dynamic_stepper<table, Pair, true>(scene, equations, keeps_ledger);
    default: return dynamic_stepper<table, Pack<4>, true>(scene, equations, keeps_ledger);
  }
}

/// The stepper of an explicit Runge-Kutta method. One that is written for the form of the equations
/// is the fastest; what is rarer has its state in memory, with the same bits: long chains,
/// compensated steps, and runs that keep the ledger.
template <const auto& table>
std::unique_ptr<Stepper> explicit_stepper(const Scene& scene, const EquationsOfMotion& equations,
                                          bool keeps_ledger, bool compensated) {
  if (compensated) return compensated_stepper<table>(scene, equations, keeps_ledger);
  if (keeps_ledger) return dynamic_stepper<table, Pack<4>, false>(scene, equations, true);
  return std::visit(
      [&]<class Form>(const Form& form) -> std::unique_ptr<Stepper> {
        if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>>) {
          return dynamic_stepper<table, Pack<4>, false>(scene, equations, false);
        } else {
          using System = FirstOrder<Form>;
          return std::make_unique<RungeKuttaFixed<table, System>>(System{form}, equations.effects);
        }
      },
      equations.form);
}

extern template std::unique_ptr<Stepper> explicit_stepper<dormand_prince_5>(
    const Scene&, const EquationsOfMotion&, bool, bool);
extern template std::unique_ptr<Stepper> explicit_stepper<dormand_prince_8>(
    const Scene&, const EquationsOfMotion&, bool, bool);

}  // namespace pendcore
