/// \file
/// The form of the equations of motion that a scene calls for.
///
/// A scene is compiled once, into a kernel that computes what the scene has and nothing else. One
/// or two links have a closed form, which is bare where the scene has no effects but payloads and
/// rotors in joint 1. More links take the recursion of a chain.
#pragma once

#include <variant>

#include "dynamics/chain/chain.hpp"
#include "dynamics/closed_form/double_pendulum_with_effects.hpp"
#include "dynamics/closed_form/single_pendulum.hpp"
#include "dynamics/closed_form/single_pendulum_with_effects.hpp"

namespace pendcore {

class HeldJoints;

struct EquationsOfMotion {
  std::variant<SinglePendulum, DoublePendulum, SinglePendulumWithEffects,
               DoublePendulumWithEffects<Parts::couples>, DoublePendulumWithEffects<Parts::waves>,
               DoublePendulumWithEffects<Parts::laws>, DoublePendulumWithEffects<Parts::everything>,
               std::shared_ptr<Chain>>
      form;
  std::shared_ptr<EffectsOfRun> effects = nullptr;    ///< null for a bare form
  std::shared_ptr<HeldJoints> held_joints = nullptr;  ///< null where no law may change

  /// Whether no effect changes its law or holds a joint along a run.
  bool are_steady() const { return held_joints == nullptr; }
  /// Whether friction or stops may hold a joint; locks do in any case.
  bool can_hold() const;
  bool may_have_held_joints() const { return can_hold() || (effects && effects->any_held); }
};

/// Whether all effects of a scene only change constants of links that turn freely: payloads, and
/// rotors in joint 1.
bool is_bare(const Scene& scene);

/// Whether some effect has modes (effects/behaviour.hpp), a stop or a lock.
bool laws_may_change(const Scene& scene);

/// The equations of a scene that check() passed.
EquationsOfMotion equations_of_motion(const Scene& scene);

/// Computes qdd (rad/s^2) from the time (s), angles (rad) and rates (rad/s), (n) each, with the
/// same bits as in a run. Effects are put in the modes that the state calls for, and joints at rest
/// are held where friction and stops can hold them. Cost: a right-hand side, and a decision of
/// HeldJoints where the scene has friction or stops. Throws what a user's function throws.
/// Equations with effects serve one thread at a time, and so do their copies: they share modes and
/// memory for the computation.
void accelerations(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
                   double* qdd);

/// The right-hand side of equations in their form, for a caller that asks for it at every stage. It
/// computes qdd in the current modes and with the joints that are held now.
struct RightHandSide {
  const void* form;
  void (*compute)(const void* form, double t, const double* q, const double* qd, double* qdd);
  /// The derivatives (qd, qdd) of three states (q, qd) of two links at three times, all in a row,
  /// at less than the cost of three; null if this form has no kernel for them.
  void (*compute_three)(const void* form, const double* t, const double* y, double* dydt) = nullptr;

  void operator()(double t, const double* q, const double* qd, double* qdd) const {
    compute(form, t, q, qd, qdd);
  }
};

/// The equations must outlive their right-hand side.
RightHandSide right_hand_side(const EquationsOfMotion& equations);

/// The same, for one state.
void accelerations_in_force(const EquationsOfMotion& equations, double t, const double* q,
                            const double* qd, double* qdd);

/// The mode of an effect that a state calls for. Where two modes meet, `forward`, the direction of
/// time, decides.
int mode_at(const EffectBehaviour& effect, double t, const double* q, const double* qd,
            bool forward);
/// Freezes every effect to that mode.
void choose_modes(EffectsOfRun& effects, double t, const double* q, const double* qd, bool forward);

}  // namespace pendcore
