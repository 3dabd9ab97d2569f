/// \file
/// What an effect says of itself, `info` and `parameters` (hooks.hpp has the whole contract), and
/// the checks that follow from it.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "pendcore/text/message.hpp"

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
  /// Whether the Taylor series support the effect, if it is part of the equations of motion. Among
  /// effects that are laws, couples have a series and others do not.
  bool has_series = false;
  /// Calls in Python that make such an effect, with values that make sense together, a line each;
  /// lines before them prepare it. The documentation shows them and runs the first.
  std::string_view examples = {};
  /// What that one does to the textbook's rods within 1 s: its entry in the ledger, or the angles.
  std::string_view outcome = {};
};

/// Allowed values of a number.
enum class Range { any, not_negative, positive, at_least_one, positive_or_infinite, share, number };

constexpr std::string_view text(Range range) {
  switch (range) {
    case Range::any: return "finite";
    case Range::not_negative: return "finite and >= 0";
    case Range::positive: return "finite and > 0";
    case Range::at_least_one: return "finite and >= 1";
    case Range::positive_or_infinite: return "> 0, inf for no limit";
    case Range::share: return "0 to 1";
    case Range::number: return "a number; -inf or inf for none";
  }
  return "";
}

inline bool holds(Range range, double x) {
  switch (range) {
    case Range::any: return std::isfinite(x);
    case Range::not_negative: return std::isfinite(x) && x >= 0;
    case Range::positive: return std::isfinite(x) && x > 0;
    case Range::at_least_one: return std::isfinite(x) && x >= 1;
    case Range::positive_or_infinite: return x > 0;
    case Range::share: return x >= 0 && x <= 1;
    case Range::number: return !std::isnan(x);
  }
  return false;
}

struct ParameterInfo {
  std::string_view name;    ///< as in Python and TOML
  std::string_view symbol;  ///< as in the law; empty if it is not a quantity
  std::string_view unit;
  std::string_view sentence;
  Range range = Range::any;
  bool required = false;                                    ///< if not, the struct has the default
  std::array<std::string_view, 2> components = {"x", "y"};  ///< the names of a pair's two numbers
};

template <class Struct, class Value>
struct Parameter {
  Value Struct::* field;
  ParameterInfo info;
};

template <class Struct, class Value>
constexpr Parameter<Struct, Value> parameter(Value Struct::* field, ParameterInfo info) {
  return {field, info};
}

inline constexpr ParameterInfo joint_number{
    .name = "joint",
    .symbol = "j",
    .unit = "",
    .sentence = "the joint at which it acts, counted from 1",
    .required = true};
inline constexpr ParameterInfo link_number{.name = "link",
                                           .symbol = "i",
                                           .unit = "",
                                           .sentence = "the link on which it acts, counted from 1",
                                           .required = true};

/// Calls visit(info, value) for each parameter.
template <class Struct, class Visitor>
void for_each_parameter(Struct& effect, Visitor visit) {
  std::apply([&](const auto&... p) { (visit(p.info, effect.*(p.field)), ...); },
             std::remove_cvref_t<Struct>::parameters);
}

/// A part of an effect with parameters of its own, such as a Sinusoid, that may be left out.
template <class Value>
concept OptionalPart = requires { Value::value_type::parameters; };

/// The hook `check` (hooks.hpp), which parts may have too.
template <class Struct>
concept HasCheck = requires(const Struct& one, const std::string& where) {
  { one.check(where) } -> std::same_as<void>;
};

/// Throws std::invalid_argument for a parameter out of its range, naming it after `where`, as in
/// "effect 2 (viscous_joint): ".
void check_value(const std::string& where, const ParameterInfo& info, double value);

template <class Struct>
void check_parameters(const std::string& where, const Struct& effect) {
  for_each_parameter(effect, [&]<class Value>(const ParameterInfo& info, const Value& value) {
    if constexpr (std::is_same_v<Value, int>) {
      if (value < 1) {
        throw std::invalid_argument(where + std::string(info.name) + " = " + std::to_string(value) +
                                    ": must be a whole number, 1 or more");
      }
    } else if constexpr (std::is_same_v<Value, double>) {
      check_value(where, info, value);
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      if (value) check_value(where, info, *value);
    } else if constexpr (requires { value.begin(); }) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        ParameterInfo element = info;
        const std::string name = std::string(info.name) + "[" + std::to_string(i) + "]";
        element.name = name;
        check_value(where, element, value[i]);
      }
    } else if constexpr (OptionalPart<Value>) {
      if (value) check_parameters(where + std::string(info.name) + ".", *value);
    }
  });
  if constexpr (HasCheck<Struct>) effect.check(where);
}

}  // namespace pendcore
