/// \file
/// The list of effects. Python, case files, documents and WebAssembly know those that it names.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

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

/// Their kinds. Tables and documents have the order of this list.
using EffectKinds = std::tuple<  //
    ViscousJoint,                //
    DryJointFriction,            //
    RodDrag,                     //
    TorsionalSpring,             //
    Motor,                       //
    RotorInertia,                //
    Payload,                     //
    Lock,                        //
    JointStop,                   //
    DrivenPivot,                 //
    CompiledUser>;

/// Calls visit(effect) for an effect of each kind with its default parameters.
template <class Visit>
void for_each_kind(const Visit& visit) {
  std::apply([&](const auto&... kinds) { (visit(kinds), ...); }, EffectKinds{});
}

/// Calls visit(parameters) with the parameters of an effect in their own type.
template <class Visit>
void visit_parameters(const Effect& effect, const Visit& visit) {
  for_each_kind([&]<class Kind>(const Kind&) {
    if (const Kind* const given = effect.get_if<Kind>()) visit(*given);
  });
}

/// The effect of a kind with the parameters that fill(parameters) puts in place of the defaults.
/// Throws std::invalid_argument for an unknown kind.
template <class Fill>
Effect effect_of_kind(std::string_view kind, const Fill& fill) {
  std::optional<Effect> made;
  for_each_kind([&]<class Kind>(Kind given) {
    if (Kind::info.kind != kind) return;
    fill(given);
    made = std::move(given);
  });
  if (!made) {
    throw std::invalid_argument("kind = \"" + std::string(kind) + "\": there is no such effect");
  }
  return *std::move(made);
}

}  // namespace pendcore
