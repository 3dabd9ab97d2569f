/// \file
/// A run as numbers, strings and arrays of numbers, so that it fits a pickle and an npz alike.
#pragma once

#include "run.hpp"

namespace pendcore::bindings {

py::dict statistics(const Statistics& statistics);

py::dict get_state(const Run& run);

/// Throws ValueError for a state whose parts do not fit together.
Run set_state(const py::dict& state);

}  // namespace pendcore::bindings
