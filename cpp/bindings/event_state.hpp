/// \file
/// The events of a solution as strings and arrays of numbers, for pickles and npz.
#pragma once

#include "run.hpp"

namespace pendcore::bindings {

/// Adds them to the fields of a state. TypeError for an event that is a function.
void put_events(py::dict& fields, const Solution& solution);

/// Takes them out. Throws ValueError for what does not fit together, and for a function: a file
/// that could name one could have anything called.
void take_events(const py::dict& fields, Solution& solution);

}  // namespace pendcore::bindings
