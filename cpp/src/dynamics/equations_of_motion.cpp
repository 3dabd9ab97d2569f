#include "dynamics/equations_of_motion.hpp"

#include <algorithm>

#include "dynamics/accelerations_kernel.hpp"
#include "dynamics/chain/chain_recursion.hpp"
#include "dynamics/contact/held_joints.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rotor_inertia.hpp"

namespace pendcore {

bool EquationsOfMotion::can_hold() const { return held_joints && held_joints->can_hold(); }

bool is_bare(const Scene& scene) {
  return std::ranges::all_of(scene.effects, [](const Effect& effect) {
    return effect.is<Payload>() || (effect.is<RotorInertia>() && effect->joint() == 1);
  });
}

bool laws_may_change(const Scene& scene) {
  return std::ranges::any_of(scene.effects, [](const Effect& effect) {
    return effect.is<Lock>() || effect.is<JointStop>() || effect->has_modes();
  });
}

namespace {

template <class Form>
PENDCORE_INLINE void accelerations_of_form(const void* form, double t, const double* q,
                                           const double* qd, double* qdd) {
  accelerations_in_memory(static_cast<const Form*>(form), t, q, qd, qdd);
}

template <class Form>
PENDCORE_INLINE void derivatives_of_three_of_form(const void* form, const double* t,
                                                  const double* y, double* dydt) {
  derivatives_of_three(static_cast<const Form*>(form), t, y, dydt);
}

EquationsOfMotion form_of_motion(const Scene& scene) {
  const Inertia inertia(scene);
  const std::size_t n = scene.links.size();
  if (n == 1 && is_bare(scene)) return {SinglePendulum(inertia, scene.gravity)};
  if (n == 2 && is_bare(scene)) return {DoublePendulum(scene, inertia), nullptr};
  if (n == 1) {
    auto effects = std::make_shared<EffectsInRows<double>>(scene);
    return {SinglePendulumWithEffects(scene, inertia, effects.get()), effects};
  }
  if (n == 2) {
    auto effects = std::make_shared<EffectsInRows<Pair>>(scene);
    const auto* in_force = effects.get();
    const bool has_spline = std::ranges::any_of(scene.effects, [](const Effect& effect) {
      return effect.info().moves_pivot && effect->has_modes();
    });
    if (effects->entries.empty() && effects->users.empty() && !has_spline && effects->waves > 0 &&
        effects->waves <= 2) {
      return {DoublePendulumWithEffects<Parts::waves>(scene, inertia, in_force), effects};
    }
    if (effects->waves > 0 || !effects->pivots.empty() || !effects->users.empty()) {
      return {DoublePendulumWithEffects<Parts::everything>(scene, inertia, in_force), effects};
    }
    if (!effects->entries.empty()) {
      return {DoublePendulumWithEffects<Parts::laws>(scene, inertia, in_force), effects};
    }
    return {DoublePendulumWithEffects<Parts::couples>(scene, inertia, in_force), effects};
  }
  auto effects = std::make_shared<EffectsInRows<Pack<4>>>(scene);
  return {std::make_shared<Chain>(scene, effects), effects};
}

}  // namespace

EquationsOfMotion equations_of_motion(const Scene& scene) {
  EquationsOfMotion equations = form_of_motion(scene);
  if (laws_may_change(scene)) equations.held_joints = std::make_shared<HeldJoints>(scene);
  return equations;
}

int mode_at(const EffectBehaviour& effect, double t, const double* q, const double* qd,
            bool forward) {
  const int joint = effect.joint();
  const double phi = joint > 0 ? relative(q, joint) : 0.0;
  const double phid = joint > 0 ? relative(qd, joint) : 0.0;
  return effect.mode_at(t, phi, phid, forward);
}

void choose_modes(EffectsOfRun& effects, double t, const double* q, const double* qd,
                  bool forward) {
  for (std::size_t i = 0; i < effects.effects.size(); ++i) {
    const EffectBehaviour& effect = *effects.effects[i];
    if (effect.has_modes()) effects.put_mode(i, mode_at(effect, t, q, qd, forward));
  }
}

RightHandSide right_hand_side(const EquationsOfMotion& equations) {
  return std::visit(
      []<class Form>(const Form& form) -> RightHandSide {
        if constexpr (std::is_same_v<Form, std::shared_ptr<Chain>>) {
          static const auto compute = fastest<&accelerations_of_form<Chain>, wide_sets>();
          return {form.get(), compute};
        } else {
          static const auto compute = fastest<&accelerations_of_form<Form>>();
          if constexpr (has_special_kernels_of_rare_runs && takes_states_in_lanes<Form>) {
            static const auto three = fastest<&derivatives_of_three_of_form<Form>, special_sets>();
            return {&form, compute, instruction_set() < special_sets.least ? nullptr : three};
          }
          return {&form, compute};
        }
      },
      equations.form);
}

void accelerations_in_force(const EquationsOfMotion& equations, double t, const double* q,
                            const double* qd, double* qdd) {
  right_hand_side(equations)(t, q, qd, qdd);
}

void accelerations(const EquationsOfMotion& equations, double t, const double* q, const double* qd,
                   double* qdd) {
  if (equations.effects && equations.effects->has_modes) {
    choose_modes(*equations.effects, t, q, qd, true);
  }
  if (!equations.can_hold()) return accelerations_in_force(equations, t, q, qd, qdd);
  const std::vector<double> rates = equations.held_joints->without_rounding(qd);
  equations.held_joints->choose(equations, t, q, rates.data());
  accelerations_in_force(equations, t, q, rates.data(), qdd);
}

}  // namespace pendcore
