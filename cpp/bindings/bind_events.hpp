/// \file
/// Converts events to Python's numbers, and back: a pair (kind, values), with values by their
/// names.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/solution.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

/// The event of a pair. The kind "function" has a Python function as `f`; whoever holds the event
/// must keep it alive.
Event make_event(py::handle kind_and_values);

/// The pair of an event. If the event is a function, the pair has `f` for it.
py::tuple kind_and_values(const Event& event, const py::object& f);

/// The pair of an event, for a pickle or a file. Raises TypeError for a function, which cannot be
/// kept.
py::tuple saved_event(const Event& event, std::size_t i);

/// The Python function of each event, or None.
py::list functions_of(const py::sequence& events);

}  // namespace pendcore::bindings
