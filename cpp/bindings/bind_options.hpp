/// \file
/// Converts the options of a run to Python's values, and back.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/options.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

/// Options by their names, for a chain of n links; those that are missing, or None where that is
/// allowed, have their defaults. TypeError and ValueError for what is not of an option's type.
Options options_of(const py::dict& given, std::size_t n);

/// All options except the events by their names, as `options_of` takes them.
py::dict as_python(const Options& options);

}  // namespace pendcore::bindings
