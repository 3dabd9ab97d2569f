/// \file
/// A Python function as the core calls it: with Python's lock, and with the arrays that the
/// function is promised.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>

#include "pendcore/effects/user.hpp"
#include "pendcore/events.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

/// f(t, q, qd) -> Q as an effect that may jump at the times of `breaks`. Whoever holds the effect
/// keeps the function alive.
CompiledUser effect_of_function(py::handle function, const std::vector<double>& breaks);

/// f(t, q, qd) -> a number, as the function of an event. Whoever holds the event keeps f alive:
/// copies are made without Python's lock, and count no references.
std::function<double(double, std::span<const double>, std::span<const double>)> event_function(
    py::handle function);

/// An exception of Python with its traceback; one of the core as Python has it.
py::object python_exception(const py::error_already_set& raised);
py::object python_exception(const std::exception_ptr& error);

}  // namespace pendcore::bindings
