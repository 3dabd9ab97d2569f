/// \file
/// A solution as Python holds it: with its scene, so that it can go on, and with the exception that
/// broke it off, if one did.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/pendcore.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

struct Run {
  Scene scene;
  Solution solution;
  py::object python_scene = py::none();  ///< keeps the functions among its effects alive
  py::list event_functions{};            ///< of each event: its Python function, or None
  py::object error = py::none();
};

}  // namespace pendcore::bindings
