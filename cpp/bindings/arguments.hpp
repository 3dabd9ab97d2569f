/// \file
/// Converts Python's numbers and arrays to the core's. An error names the argument.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
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

inline py::str string(std::string_view text) { return {text.data(), text.size()}; }

/// A real number. TypeError for booleans, strings, complex numbers and arrays with axes.
double number(const char* name, py::handle value);
std::optional<double> optional_number(const char* name, py::handle value);

/// A whole number. TypeError for anything else.
long long whole_number(const char* name, py::handle value);

/// True or false, NumPy's as well. TypeError for anything else.
bool truth(const char* name, py::handle value);

/// Real numbers along one axis; a number alone counts as `copies` of it. TypeError for what is not
/// real numbers. ValueError for more axes; its message gives the shape that is `wanted`.
std::vector<double> numbers(const char* name, py::handle value, const std::string& wanted = "(k,)",
                            std::size_t copies = 1);

/// Takes what needs no conversion, and raises nothing for anything else: the caller says what is
/// wrong with it. `x` is a finite number alone; `into` takes as many of them as it has room for,
/// from a list, a tuple, or an array of doubles with one axis.
bool take_plain(py::handle value, double& x);
bool take_plain(py::handle value, std::span<double> into);

/// A read-only array of that shape over numbers that `owner` keeps alive.
py::array view(const std::vector<double>& numbers, std::vector<py::ssize_t> shape,
               py::handle owner);

/// An array of that shape with a copy of the numbers.
py::array copy(std::span<const double> numbers, std::vector<py::ssize_t> shape);

}  // namespace pendcore::bindings
