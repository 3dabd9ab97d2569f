/// \file
/// A solution as Python holds it: with its scene, so that it can be resumed, and with the exception
/// that ended it, if there was one.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/pendcore.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

struct Run {
  Scene scene;
  Solution solution;
  py::object python_scene = py::none();  ///< keeps the functions among its effects alive
  py::list event_functions{};            ///< the Python function of each event, or None
  py::object error = py::none();
};

}  // namespace pendcore::bindings
