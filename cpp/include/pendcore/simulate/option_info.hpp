/// \file
/// The descriptor of an option of a run. Checks, messages, Python, case files and pages read all
/// that they say of an option from here.
#pragma once

#include <cmath>
#include <concepts>
#include <string>
#include <string_view>

#include "pendcore/integrate/loop/integrate.hpp"
#include "pendcore/text/message.hpp"

namespace pendcore {

/// Which numbers are allowed.
struct NumberRange {
  double least = 0.0;
  bool includes_least = false;
  bool includes_infinity = false;
};

struct OptionInfo {
  std::string_view name;
  std::string_view unit = {};
  NumberRange range = {};         ///< of an option that is a number
  std::string_view type = {};     ///< as docstrings give it, unless the type of the field says it
  std::string_view if_none = {};  ///< what a run does if the option is not given and has no default
  std::string_view sentence;
  bool chosen_for_error = false;     ///< `simulate(error=...)` chooses it
  bool limits_every_method = false;  ///< a comparison of methods gives it to each of them
};

/// "finite and > 0".
inline std::string in_words(const NumberRange& range) {
  const bool is_whole = range.least == std::floor(range.least);
  return std::string(range.includes_infinity ? "" : "finite and ") +
         (range.includes_least ? ">= " : "> ") +
         (is_whole ? std::to_string(static_cast<long long>(range.least)) : text(range.least));
}

/// "finite and > 0 (s)".
inline std::string range_with_unit(const OptionInfo& info) {
  return in_words(info.range) + (info.unit.empty() ? "" : " (" + std::string(info.unit) + ")");
}

/// What an option is: a struct with one field, which `field` points to, and its descriptor. An
/// option that the loop over steps knows has a function `limit` as well, which tells the loop.
template <class Option>
concept RunOption = requires(Option option) {
  { Option::info } -> std::convertible_to<OptionInfo>;
  option.*Option::field;
};

/// The fields of all options side by side, in the order of their list.
template <RunOption... Listed>
struct OptionList : Listed... {
  /// Calls visit<Option>() for each of them.
  template <class Visit>
  static void for_each(Visit visit) {
    (visit.template operator()<Listed>(), ...);
  }
  /// Whether is<Option>() holds for one of them; it is asked until it does.
  template <class Is>
  static bool any_of(Is is) {
    return (is.template operator()<Listed>() || ...);
  }

  void limit(Limits& limits) const { (limit_by<Listed>(limits), ...); }

 private:
  template <class Option>
  void limit_by(Limits& limits) const {
    if constexpr (requires(const Option& option) { option.Option::limit(limits); }) {
      Option::limit(limits);
    }
  }
};

}  // namespace pendcore
