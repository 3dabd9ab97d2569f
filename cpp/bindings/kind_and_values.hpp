/// \file
/// Effects and events as they come from Python and from files: pairs (kind, values), with values by
/// the names of the parameters. The conversions use descriptors, and name no effect.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>

#include "pendcore/effects/effect.hpp"
#include "pendcore/events.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

using KindAndValues = std::pair<std::string, py::object>;

/// The effect of a pair. Parameters that are not given have their defaults. For the kind "user" the
/// values are a Python function and the times at which it may jump.
Effect make_effect(py::handle kind_and_values);

/// The pair of an effect. Values are numbers, tuples, dictionaries for parts with parameters of
/// their own, and None.
py::tuple kind_and_values(const Effect& effect);

/// The event of a pair. The kind "function" has a Python function as `f`; whoever holds the event
/// must keep it alive.
Event make_event(py::handle kind_and_values);

/// The pair of an event. If the event is a function, the pair has `f` for it.
py::tuple kind_and_values(const Event& event, const py::object& f);

/// The Python function of each event, or None.
py::list functions_of(const py::sequence& events);

}  // namespace pendcore::bindings
