/// \file
/// Converts effects to Python's numbers, and back. It only uses their descriptors, and names no
/// effect.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/effects/effect.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

/// The effect of a pair (kind, values), with values by the names of the parameters. Parameters that
/// are not given have their defaults. For the kind "user" the values are a Python function.
Effect make_effect(py::handle kind_and_values);

/// The pair of an effect. Values are numbers, tuples, dictionaries for parts with parameters of
/// their own, and None. Raises TypeError for a function, which cannot be kept.
py::tuple kind_and_values(const std::string& where, const Effect& effect);

}  // namespace pendcore::bindings
