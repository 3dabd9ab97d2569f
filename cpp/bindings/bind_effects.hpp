/// \file
/// Effects as Python's numbers, and back: from their descriptors alone, so that no effect is named.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/effects/registry.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

/// The effect of a pair (kind, values), values by the names of the parameters; what is not given
/// has its default. The kind "user" has a Python function for its values.
Effect make_effect(py::handle kind_and_values);

/// The pair of an effect: numbers, tuples, dictionaries for what has parameters of its own, None.
/// TypeError for a function, of which there is nothing to keep.
py::tuple kind_and_values(const std::string& where, const Effect& effect);

}  // namespace pendcore::bindings
