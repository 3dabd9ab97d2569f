/// \file
/// The descriptors of what users give: parameters of effects and events, and options of a run.
/// Checks, messages, Python, case files, pages and WebAssembly read all that they say of one from
/// here.
///
/// A struct with such fields lists them in `parameters`, a tuple of parameter(&Struct::field, ...).
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace pendcore {

/// Allowed values of a number.
enum class Range {
  any,
  not_negative,
  positive,
  at_least_one,
  positive_or_infinite,
  share,
  number,
  count
};

inline constexpr auto range_texts = std::to_array<std::string_view>(
    {"finite", "finite and >= 0", "finite and > 0", "finite and >= 1", "> 0, inf for no limit",
     "0 to 1", "a number; -inf or inf for none", "a whole number, 1 or more"});

constexpr std::string_view text(Range range) {
  return range_texts[static_cast<std::size_t>(range)];
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
    case Range::count: return x >= 1;
  }
  return false;
}

struct ParameterInfo {
  std::string_view name;         ///< as in Python and TOML
  std::string_view symbol = {};  ///< as in the law; empty if it is not a quantity
  std::string_view unit = {};
  std::string_view sentence = {};
  Range range = Range::any;
  bool required = false;                                    ///< if not, the struct has the default
  std::array<std::string_view, 2> components = {"x", "y"};  ///< the names of a pair's two numbers
  std::string_view type = {};     ///< as docstrings give it, unless the type of the field says it
  std::string_view if_none = {};  ///< what happens if it is not given and has no default
  bool one_may_stand_for_all = false;  ///< a list that a single number may stand for
  bool chosen_for_error = false;       ///< an option that `simulate(error=...)` chooses
  bool limits_every_method = false;    ///< an option that a comparison gives to each method
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

/// Calls visit(info, value) for each parameter.
template <class Struct, class Visitor>
void for_each_parameter(Struct& given, Visitor visit) {
  std::apply([&](const auto&... p) { (visit(p.info, given.*(p.field)), ...); },
             std::remove_cvref_t<Struct>::parameters);
}

}  // namespace pendcore
