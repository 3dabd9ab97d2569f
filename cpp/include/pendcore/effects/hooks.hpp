/// \file
/// The contract of an effect: what a file in this folder contains, and a check that it does.
///
/// An effect is a plain struct of parameters. Its file opens with the law; the struct has
///
///     info         its name, a sentence, the source, where the ledger books its work, and what
///                  else others must know of its kind
///     parameters   a tuple of `parameter(&Struct::field, {...})`: symbol, unit, range, a sentence
///     hooks        which of the hooks below it has, such as {.couple = true, .modes = true}
///
/// and the hooks that it names:
///
///     couple          couple(mode): its torque on a joint, if that is a polynomial: see law.hpp
///     law             Law<Row>: any other couples at joints, and forces along links;
///                     put(law, lane, on): its parameters into the lane of its joint or link
///     group           group(): effects on one row share a law if this number is the same
///     wind            has_wind(), and of its law dissipation(at): the part of its power that is
///                     lost; the rest is the wind's
///     modes           has_modes(), mode_at(t, phi, phid, forward), guards(mode),
///                     next_mode(mode, guard): for a law that is only piecewise smooth, see
///                     law.hpp; with the hook `law` also put_mode(law, lane, mode): what a mode
///                     changes in its lane
///     next_time       next_time(t, forward): the next time at which a mode changes
///     span            first_time(), last_time(): where its tables begin and end
///     wave            wave(): the sinusoid that drives its couple, if one does
///     holding_torque  holding_torque(): the torque with which it can hold its joint at rest
///     compiled        compiled(): the same effect, with all that is computed only once
///     potential       potential(phi): energy kept in the joint, J
///     check           check(where): what the ranges of single parameters do not say
///     warnings        warnings(): what is possible but hardly intended, a sentence each
///
/// registry.hpp has the list of all effects, a line for each. No other code names an effect that is
/// a law. Effects that change the mass matrix, the joints or the pivot (payload, rotor, lock, stop,
/// driven pivot) are part of the equations of motion, which name them.
/// The Python class, the TOML keys, the repr, the checks and their messages, the page of
/// documentation and the tests come from `info` and `parameters`.
///
/// Code that calls a hook asks by a concept whether an effect has it, such as HasCouple for
/// `couple`. A misspelt hook would be a hook that the effect does not have. Therefore `hooks` names
/// them, and a registry does not compile if an effect has other hooks than it names (CheckedHooks).
#pragma once

#include <concepts>
#include <utility>
#include <variant>

#include "pendcore/effects/effect.hpp"
#include "pendcore/effects/law.hpp"
#include "pendcore/effects/wave.hpp"

namespace pendcore {

/// Which hooks an effect has.
struct Hooks {
  bool couple = false;
  bool law = false;
  bool group = false;
  bool wind = false;
  bool modes = false;
  bool next_time = false;
  bool span = false;
  bool wave = false;
  bool holding_torque = false;
  bool compiled = false;
  bool potential = false;
  bool check = false;
  bool warnings = false;
};

template <class Kind>
concept OnJoint = requires(const Kind& one) {
  { one.joint } -> std::same_as<const int&>;
};

template <class Kind>
concept OnLink = requires(const Kind& one) {
  { one.link } -> std::same_as<const int&>;
};

namespace hooks_detail {

/// What a concept passes to a law instead of the rows of an equation.
struct At {
  using Value = double;
};
struct Loads {};

}  // namespace hooks_detail

template <class Kind>
concept HasCouple = OnJoint<Kind> && requires(const Kind& one, int mode) {
  { one.couple(mode) } -> std::same_as<std::optional<Couple>>;
};

template <class Kind>
concept HasLaw =
    (OnJoint<Kind> || OnLink<Kind>) &&
    requires(const Kind& one, typename Kind::template Law<double>& law, const LinkConstants& on,
             const hooks_detail::At& at, hooks_detail::Loads& loads) {
      { one.put(law, 0, on) } -> std::same_as<void>;
      { std::as_const(law).add(at, loads) } -> std::same_as<void>;
    };

template <class Kind>
concept HasGroup = HasLaw<Kind> && requires(const Kind& one) {
  { one.group() } -> std::same_as<double>;
};

/// Whether a law computes the part of its power that is lost.
template <class Law>
concept Dissipates = requires(const Law& law, const hooks_detail::At& at) {
  { law.dissipation(at) } -> std::same_as<double>;
};

template <class Kind>
concept HasWind =
    HasLaw<Kind> && Dissipates<typename Kind::template Law<double>> && requires(const Kind& one) {
      { one.has_wind() } -> std::same_as<bool>;
    };

template <class Kind, class Law>
concept PutsModeInto = requires(const Kind& one, Law& law) {
  { one.put_mode(law, 0, 0) } -> std::same_as<void>;
};

template <class Kind>
concept HasModes = requires(const Kind& one, double t, double phi, double phid, bool forward,
                            int mode, std::size_t guard) {
  { one.has_modes() } -> std::same_as<bool>;
  { one.mode_at(t, phi, phid, forward) } -> std::same_as<int>;
  { one.guards(mode) } -> std::same_as<std::vector<Guard>>;
  { one.next_mode(mode, guard) } -> std::same_as<int>;
} && (!HasLaw<Kind> || PutsModeInto<Kind, typename Kind::template Law<double>>);

template <class Kind>
concept HasNextTime = HasModes<Kind> && requires(const Kind& one, double t, bool forward) {
  { one.next_time(t, forward) } -> std::same_as<double>;
};

template <class Kind>
concept HasSpan = requires(const Kind& one) {
  { one.first_time() } -> std::same_as<double>;
  { one.last_time() } -> std::same_as<double>;
};

template <class Kind>
concept HasWave = HasCouple<Kind> && requires(const Kind& one) {
  { one.wave() } -> std::same_as<std::optional<Sinusoid>>;
};

template <class Kind>
concept HasHoldingTorque = OnJoint<Kind> && requires(const Kind& one) {
  { one.holding_torque() } -> std::same_as<double>;
};

template <class Kind>
concept HasCompiled = requires(const Kind& one) {
  { one.compiled() } -> std::same_as<Kind>;
};

template <class Kind>
concept HasPotential = OnJoint<Kind> && requires(const Kind& one, double phi) {
  { one.potential(phi) } -> std::same_as<double>;
};

template <class Kind>
concept HasWarnings = requires(const Kind& one) {
  { one.warnings() } -> std::same_as<std::vector<std::string>>;
};

namespace hooks_detail {

/// The names of all hooks. If an effect has any member with one of these names, the name is
/// ambiguous in Beside. So even a hook that could not be called is found.
struct Names {
  int couple, put, group, has_wind, has_modes, mode_at, guards, next_mode, put_mode, next_time,
      first_time, last_time, wave, holding_torque, compiled, potential, check, warnings;
};
template <class Kind>
struct Beside : Kind, Names {};

/// The hooks of which an effect has at least one member.
template <class Kind>
consteval Hooks begun() {
  using Both = Beside<Kind>;
  Hooks any;
  any.couple = !requires { &Both::couple; };
  any.law = requires { typename Kind::template Law<double>; };
  any.law |= !requires { &Both::put; };
  any.group = !requires { &Both::group; };
  if constexpr (HasLaw<Kind>) any.wind = Dissipates<typename Kind::template Law<double>>;
  any.wind |= !requires { &Both::has_wind; };
  any.modes = !requires { &Both::has_modes; };
  any.modes |= !requires { &Both::mode_at; };
  any.modes |= !requires { &Both::guards; };
  any.modes |= !requires { &Both::next_mode; };
  any.modes |= !requires { &Both::put_mode; };
  any.next_time = !requires { &Both::next_time; };
  any.span = !requires { &Both::first_time; };
  any.span |= !requires { &Both::last_time; };
  any.wave = !requires { &Both::wave; };
  any.holding_torque = !requires { &Both::holding_torque; };
  any.compiled = !requires { &Both::compiled; };
  any.potential = !requires { &Both::potential; };
  any.check = !requires { &Both::check; };
  any.warnings = !requires { &Both::warnings; };
  return any;
}

template <class Kind>
consteval Hooks named() {
  if constexpr (requires { Kind::hooks; }) return Kind::hooks;
  return {};
}

}  // namespace hooks_detail

/// Does not compile if an effect has other hooks than it names; the message says which.
template <class Kind>
struct CheckedHooks {
  static_assert(
      requires {
        { Kind::hooks } -> std::same_as<const Hooks&>;
      }, "hooks: an effect has static constexpr Hooks hooks{...}");
  static constexpr Hooks named = hooks_detail::named<Kind>();
  static constexpr Hooks begun = hooks_detail::begun<Kind>();

  static_assert(named.couple ? HasCouple<Kind> : !begun.couple,
                "hook couple: .couple = true in hooks goes with std::optional<Couple> couple(int "
                "mode) const, on a joint");
  static_assert(named.law ? HasLaw<Kind> : !begun.law,
                "hook law: .law = true in hooks goes with Law<Row> with add(at, loads) const, void "
                "put(Law<Row>&, int lane, const LinkConstants&) const, on a joint or a link");
  static_assert(named.group ? HasGroup<Kind> : !begun.group,
                "hook group: .group = true in hooks goes with double group() const, with law");
  static_assert(named.wind ? HasWind<Kind> : !begun.wind,
                "hook wind: .wind = true in hooks goes with bool has_wind() const, and "
                "dissipation(at) const of the Law");
  static_assert(named.modes ? HasModes<Kind> : !begun.modes,
                "hook modes: .modes = true in hooks goes with bool has_modes() const, int "
                "mode_at(double t, double phi, double phid, bool forward) const, "
                "std::vector<Guard> guards(int mode) const, int next_mode(int mode, std::size_t "
                "guard) const; with law, void put_mode(Law<Row>&, int lane, int mode) const");
  static_assert(named.next_time ? HasNextTime<Kind> : !begun.next_time,
                "hook next_time: .next_time = true in hooks goes with double next_time(double t, "
                "bool forward) const, with modes");
  static_assert(named.span ? HasSpan<Kind> : !begun.span,
                "hook span: .span = true in hooks goes with double first_time() const, double "
                "last_time() const");
  static_assert(named.wave ? HasWave<Kind> : !begun.wave,
                "hook wave: .wave = true in hooks goes with std::optional<Sinusoid> wave() const, "
                "with couple");
  static_assert(named.holding_torque ? HasHoldingTorque<Kind> : !begun.holding_torque,
                "hook holding_torque: .holding_torque = true in hooks goes with double "
                "holding_torque() const, on a joint");
  static_assert(named.compiled ? HasCompiled<Kind> : !begun.compiled,
                "hook compiled: .compiled = true in hooks goes with compiled() const, which "
                "returns an effect of its kind");
  static_assert(named.potential ? HasPotential<Kind> : !begun.potential,
                "hook potential: .potential = true in hooks goes with double potential(double phi) "
                "const, on a joint");
  static_assert(
      named.check ? HasCheck<Kind> : !begun.check,
      "hook check: .check = true in hooks goes with void check(const std::string& where) const");
  static_assert(named.warnings ? HasWarnings<Kind> : !begun.warnings,
                "hook warnings: .warnings = true in hooks goes with std::vector<std::string> "
                "warnings() const");

  static constexpr bool is_complete = true;  ///< whoever asks for it compiles the checks above
};

/// Whether all effects of a registry have the hooks that they name. If not, this does not compile.
template <class Registry>
inline constexpr bool hooks_are_named = false;
template <class... Kinds>
inline constexpr bool hooks_are_named<std::variant<Kinds...>> =
    (... && CheckedHooks<Kinds>::is_complete);

}  // namespace pendcore
