/// \file
/// The list of effects. Each effect is a file in this folder, and a line here.
#pragma once

#include <variant>

#include "pendcore/effects/driven_pivot.hpp"
#include "pendcore/effects/dry_joint_friction.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/effects/motor.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rod_drag.hpp"
#include "pendcore/effects/rotor_inertia.hpp"
#include "pendcore/effects/torsional_spring.hpp"
#include "pendcore/effects/user.hpp"
#include "pendcore/effects/viscous_joint.hpp"

namespace pendcore {

using Effect = std::variant<  //
    ViscousJoint,             //
    DryJointFriction,         //
    RodDrag,                  //
    TorsionalSpring,          //
    Motor,                    //
    RotorInertia,             //
    Payload,                  //
    Lock,                     //
    JointStop,                //
    DrivenPivot,              //
    CompiledUser>;

static_assert(hooks_are_named<Effect>);

/// Whether the recurrences of the Taylor series of the equations support the effect.
inline bool has_series(const Effect& effect) {
  return std::visit(
      []<class Kind>(const Kind& one) {
        if constexpr (HasCouple<Kind>) {
          return one.couple(0).has_value();
        } else {
          return Kind::info.has_series;
        }
      },
      effect);
}

inline const EffectInfo& info_of(const Effect& effect) {
  return std::visit([]<class Kind>(const Kind&) -> const EffectInfo& { return Kind::info; },
                    effect);
}

/// The torque with which an effect can hold its joint at rest, N m; none if it cannot.
std::optional<double> holding_torque(const Effect& effect);

/// The effect of a kind with its default parameters, to be filled in. Throws std::invalid_argument
/// for an unknown kind.
Effect effect_of_kind(std::string_view kind);

/// Throws std::invalid_argument for parameters out of their ranges; `where` begins the message.
void check_effect(const std::string& where, const Effect& effect);

}  // namespace pendcore
