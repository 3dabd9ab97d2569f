/// \file
/// Converts Python's numbers, words and arrays to the core's. An error names the argument.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <concepts>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arithmetic/bits.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

/// An array of doubles, contiguous and at multiples of 8 bytes, converted if necessary.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast |
                                      py::detail::npy_api::NPY_ARRAY_ALIGNED_>;

inline void give_nan_one_sign(Array& numbers) {
  pendcore::give_nan_one_sign({numbers.mutable_data(), static_cast<std::size_t>(numbers.size())});
}

/// "joint = 1.5", for a message.
std::string name_and_value(std::string_view name, py::handle value);
/// TypeError: "joint = 1.5: must be a whole number".
[[noreturn]] void refuse_type(std::string_view name, py::handle value, std::string_view wanted);

/// A real number. TypeError for booleans, strings, complex numbers and arrays with axes.
double number(std::string_view name, py::handle value);

/// A whole number. TypeError for anything else.
long long whole_number(std::string_view name, py::handle value);

/// True or false, NumPy's as well. TypeError for anything else.
bool truth(std::string_view name, py::handle value);

/// The UTF-8 of a text, as long as that lives. Where no encoding has it, nothing is returned and
/// Python's error is set. A cast would note the string in a table, to keep it alive.
std::optional<std::string_view> utf8(py::handle text);

/// The text; nothing is returned for anything else, or for a text that no encoding has (a lone
/// surrogate).
std::optional<std::string> text_of(py::handle value);

/// Real numbers along one axis; a number alone counts as `copies` of it. TypeError for what is not
/// real numbers. ValueError for more axes; its message gives the shape that is `wanted`.
std::vector<double> numbers(std::string_view name, py::handle value,
                            const std::string& wanted = "(k,)", std::size_t copies = 1);

/// Takes a value of any type that descriptors and the states of runs have. What is optional may be
/// None. An error leaves `into` as it is.
template <class Value>
void take(std::string_view name, py::handle value, Value& into) {
  if constexpr (std::same_as<Value, double>) {
    into = number(name, value);
  } else if constexpr (std::same_as<Value, bool>) {
    into = truth(name, value);
  } else if constexpr (std::integral<Value>) {
    const long long whole = whole_number(name, value);
    if (!std::in_range<Value>(whole)) {
      using Limits = std::numeric_limits<Value>;
      refuse_type(name, value,
                  "from " + std::to_string(Limits::min()) + " to " + std::to_string(Limits::max()));
    }
    into = static_cast<Value>(whole);
  } else if constexpr (std::same_as<Value, std::string>) {
    std::optional<std::string> text = text_of(value);
    if (!text) refuse_type(name, value, "a text");
    into = *std::move(text);
  } else if constexpr (std::same_as<Value, std::array<double, 2>>) {
    const std::vector<double> both = numbers(name, value, "(2,)");
    if (both.size() != 2) refuse_type(name, value, "two numbers");
    into = {both[0], both[1]};
  } else if constexpr (std::convertible_to<Value&, std::vector<double>&>) {
    into = numbers(name, value);
  } else {
    typename Value::value_type given{};
    const bool is_given = !value.is_none();
    if (is_given) take(name, value, given);
    into = is_given ? Value(given) : Value();
  }
}

/// Takes what needs no conversion, and raises nothing for anything else: the caller says what is
/// wrong with it. `x` is a number alone; `into` takes as many of them as it has room for, from a
/// list, a tuple, or an array of doubles with one axis.
bool take_plain(py::handle value, double& x);
bool take_plain(py::handle value, std::span<double> into);

template <std::integral... Sizes>
std::vector<py::ssize_t> shape(Sizes... sizes) {
  return {static_cast<py::ssize_t>(sizes)...};
}

/// A read-only array of that shape over numbers that `owner` keeps alive.
py::array view(const std::vector<double>& numbers, std::vector<py::ssize_t> shape,
               py::handle owner);

/// An array with a copy of the numbers, of that shape or along one axis.
py::array copy(std::span<const double> numbers, std::vector<py::ssize_t> shape);
py::array copy(std::span<const double> numbers);

}  // namespace pendcore::bindings
