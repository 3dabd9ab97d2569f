/// \file
/// Checks values by their descriptors.
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <string_view>

#include "pendcore/descriptor.hpp"

namespace pendcore {

/// Throws std::invalid_argument for a number out of its range, or one of several, naming it after
/// `where`, as in "effect 2 (viscous_joint): ".
void check_number(std::string_view where, const ParameterInfo& info, double value);
void check_numbers(std::string_view where, const ParameterInfo& info,
                   std::span<const double> values);
void check_count(std::string_view where, const ParameterInfo& info, long long value);

/// The same for a value of any type, if it consists of numbers; an integer is a count.
template <class Value>
void check_value(std::string_view where, const ParameterInfo& info, const Value& value) {
  if constexpr (std::same_as<Value, double>) {
    check_number(where, info, value);
  } else if constexpr (std::same_as<Value, std::optional<double>>) {
    if (value) check_number(where, info, *value);
  } else if constexpr (std::convertible_to<const Value&, std::span<const double>>) {
    check_numbers(where, info, value);
  } else if constexpr (std::same_as<Value, int> || std::same_as<Value, long long>) {
    check_count(where, info, value);
  }
}

}  // namespace pendcore
