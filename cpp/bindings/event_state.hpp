/// \file
/// The events of a solution as strings and arrays of numbers, for pickles and npz.
#pragma once

#include "pendcore/solution.hpp"
#include "run.hpp"

namespace pendcore::bindings {

/// Adds the events to the fields of a state. Raises TypeError for an event that is a function.
void put_events(py::dict& fields, const Solution& solution);

/// Reads the events from the fields of a state. Raises ValueError for what does not fit together,
/// and for a function: a file that could name a function could have any function called.
void take_events(const py::dict& fields, Solution& solution);

}  // namespace pendcore::bindings
