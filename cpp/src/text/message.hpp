/// \file
/// The messages for bad values: the field, the value, the allowed range, the remedy.
#pragma once

#include <charconv>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pendcore {

/// The shortest digits that read back as the same double.
inline std::string text(double x) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, x).ptr;
  std::string result(digits, end);
  if (result.find_first_not_of("-0123456789") == std::string::npos) result += ".0";
  return result;
}

/// Throws std::invalid_argument: "link 2: mass = -1.0: must be finite and > 0 (kg)".
[[noreturn]] inline void refuse(const std::string& field, double value, const std::string& range) {
  throw std::invalid_argument(field + " = " + text(value) + ": must be " + range);
}

/// Throws std::invalid_argument unless there are `size` numbers; `why` ends the message.
inline void require_size(std::string_view name, std::span<const double> numbers, std::size_t size,
                         const char* why = "") {
  if (numbers.size() == size) return;
  throw std::invalid_argument(std::string(name) + ": has " + std::to_string(numbers.size()) +
                              " numbers: must have " + std::to_string(size) + why);
}

}  // namespace pendcore
