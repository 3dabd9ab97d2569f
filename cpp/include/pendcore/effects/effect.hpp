/// \file
/// An effect of a scene, and what a kind of effect says of itself.
///
/// A kind is a plain structure of parameters, such as ViscousJoint, with
///
///     info         its name, a sentence, the source, where the ledger books its work, and what
///                  else others must know of its kind
///     parameters   a tuple of `parameter(&Struct::field, {...})`: symbol, unit, range, a sentence
///
/// and a field `joint` or `link`, if it acts on one. What it does is its behaviour, which the
/// function behaviour() makes; docs/how_to/add_an_effect.md shows one. The Python class, the TOML
/// keys, the repr, the checks and their messages, the page of documentation and the tests come from
/// `info` and `parameters`.
#pragma once

#include <array>
#include <concepts>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "pendcore/descriptor.hpp"

namespace pendcore {

/// Where the ledger books the work of an effect (J, positive as the name says).
enum class Account {
  none,     ///< the effect does no work, or stores it as energy
  viscous,  ///< loss
  dry,      ///< loss
  drag,     ///< loss; what the wind adds is booked as `wind`
  impact,   ///< loss
  motor,    ///< work
  drive,    ///< work of the drive that moves the pivot
  wind,     ///< work of moving air
  user,     ///< work
};

inline constexpr auto account_names = std::to_array<std::string_view>(
    {"none", "viscous", "dry", "drag", "impact", "motor", "drive", "wind", "user"});

constexpr std::string_view account_name(Account account) {
  return account_names[static_cast<std::size_t>(account)];
}

/// Whether what is booked is lost; otherwise it is work done on the chain.
constexpr bool is_loss(Account account) {
  return account == Account::viscous || account == Account::dry || account == Account::drag ||
         account == Account::impact;
}

struct EffectInfo {
  std::string_view name;      ///< "ViscousJoint"
  std::string_view kind;      ///< "viscous_joint"
  std::string_view sentence;  ///< what it is
  std::string_view law;       ///< the equation, in plain text
  std::string_view source;    ///< where the law comes from
  Account account = Account::none;
  bool bounds_joint = false;  ///< it may forbid a start that is close to an allowed one
  /// The effect makes the motion jump or stick, at instants that depend on the motion. There, the
  /// distance between neighbouring motions has no rate of growth.
  bool jumps_or_sticks = false;
  /// The effect may change at any time, in ways that its behaviour does not tell: it moves the
  /// pivot, or is a function of the user's.
  bool depends_on_time = false;
  bool moves_pivot = false;
  /// The effect is a function of the user's: nothing is known of its cost, or of its smoothness.
  bool is_function = false;
  /// The effect damps motions however small they are, so that a run forgets its errors.
  bool damps_small_motions = false;
  /// Whether the Taylor series support the effect, if it is part of the equations of motion. Among
  /// effects that are laws, couples have a series and others do not.
  bool has_series = false;
  /// Calls in Python that make such an effect, with values that make sense together, a line each;
  /// lines before them prepare it. The documentation shows them and runs the first.
  std::string_view examples = {};
  /// What that one does to the textbook's rods within 1 s: its entry in the ledger, or the angles.
  std::string_view outcome = {};
};

inline constexpr ParameterInfo joint_number{
    .name = "joint",
    .symbol = "j",
    .sentence = "the joint at which it acts, counted from 1",
    .required = true};
inline constexpr ParameterInfo link_number{.name = "link",
                                           .symbol = "i",
                                           .sentence = "the link on which it acts, counted from 1",
                                           .required = true};

/// A part of an effect with parameters of its own, such as a Sinusoid, that may be left out.
template <class Value>
concept OptionalPart = requires(const Value& value) {
  Value::value_type::parameters;
  value.has_value();
};

/// A time that never comes, or a bound that does not exist.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// A number that must be given: simulate() refuses a scene that leaves it so.
inline constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

class EffectBehaviour;

/// A function of the user's (user.hpp).
using UserFunction = void (*)(double t, int n, const double* q, const double* qd, double* Q,
                              void* data);

/// One effect of a scene, of any kind. It never changes: to change a parameter, assign another one.
/// Copies share what they know, so that they cost nothing.
///
///     scene.effects = {ViscousJoint{.joint = 2, .damping = 0.05}, Payload{.mass = 0.5}};
///     const ViscousJoint* joint = scene.effects[0].get_if<ViscousJoint>();
class Effect {
 public:
  template <class Kind>
    requires requires(Kind given) { behaviour(given); }
  Effect(Kind given)  // NOLINT(google-explicit-constructor): a scene lists effects of many kinds
      : Effect(behaviour(std::move(given))) {}

  const EffectInfo& info() const { return *info_; }

  /// The parameters, if the effect is of that kind; null if not. They are there until another
  /// effect is assigned.
  template <class Kind>
  const Kind* get_if() const {
    return info_ == &Kind::info ? static_cast<const Kind*>(parameters_) : nullptr;
  }
  template <class Kind>
  bool is() const {
    return info_ == &Kind::info;
  }

  /// What it does: effect->couple(mode).
  const EffectBehaviour* operator->() const { return behaviour_.get(); }
  const EffectBehaviour& operator*() const { return *behaviour_; }

 private:
  explicit Effect(std::shared_ptr<const EffectBehaviour> behaviour);

  std::shared_ptr<const EffectBehaviour> behaviour_;
  const EffectInfo* info_;
  const void* parameters_;
};

}  // namespace pendcore
