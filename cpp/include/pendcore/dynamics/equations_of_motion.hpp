/// \file
/// Which form of the equations of motion a scene calls for.
///
/// A scene is compiled once, into a kernel that holds what the scene has and nothing else: the
/// closed form of one or two links, bare where the scene has no effect but a payload and a rotor in
/// joint 1, with room for effects otherwise; the recursion of a chain for more.
#pragma once

#include <variant>

#include "pendcore/dynamics/chain/chain.hpp"
#include "pendcore/dynamics/closed_form/double_pendulum_with_effects.hpp"
#include "pendcore/dynamics/closed_form/single_pendulum.hpp"
#include "pendcore/dynamics/closed_form/single_pendulum_with_effects.hpp"
#include "pendcore/dynamics/contact/held_joints.hpp"

namespace pendcore {

struct EquationsOfMotion {
  std::variant<SinglePendulum, DoublePendulum, SinglePendulumWithEffects,
               DoublePendulumWithEffects<Parts::couples>, DoublePendulumWithEffects<Parts::waves>,
               DoublePendulumWithEffects<Parts::laws>, DoublePendulumWithEffects<Parts::everything>,
               std::shared_ptr<Chain>>
      form;
  std::shared_ptr<EffectsInForce> effects = nullptr;  ///< none for a bare form
  std::shared_ptr<HeldJoints> held_joints = nullptr;  ///< likewise
};

/// The equations of a scene that check() passed.
EquationsOfMotion equations_of_motion(const Scene& scene);

/// qdd (rad/s^2) from the time (s), angles (rad) and rates (rad/s), (n) each; the same bits as in
/// a run. Effects are in the modes that the state calls for, and joints at rest are held where
/// friction and stops can hold them. Cost: a right-hand side, and where the scene has friction or
/// stops a decision of HeldJoints. Throws what a user's function throws.
/// Equations with effects serve one thread at a time, and so do their copies: they share modes and
/// room for the computation.
void accelerations(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
                   double* qdd);

/// The same in the modes that are in force.
void accelerations_in_force(const EquationsOfMotion& equations, double t, const double* q,
                            const double* qd, double* qdd);

/// Freezes every effect to the mode that a state calls for; `forward` decides where two meet.
void choose_modes(EffectsInForce& effects, double t, const double* q, const double* qd,
                  bool forward);

}  // namespace pendcore
