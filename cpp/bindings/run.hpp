/// \file
/// A solution as Python holds it: with its scene, so that it can be resumed, and with the exception
/// that ended it, until Python raises that.
#pragma once

#include <pybind11/pybind11.h>

#include "pendcore/simulate.hpp"
#include "pendcore/solution.hpp"

namespace pendcore::bindings {

namespace py = pybind11;

struct Run {
  py::object scene;  ///< a Scene, which keeps the functions among its effects alive
  Solution solution;
  py::object event_functions{};  ///< a list: the Python function of each event, or None
  py::object error = py::none();
};

inline const Scene& scene_of(const Run& run) { return run.scene.cast<const Scene&>(); }

py::dict statistics(const Statistics& statistics);

/// The run as numbers, strings and arrays of numbers, so that it fits a pickle and an npz alike.
py::dict get_state(const Run& run);

/// Raises TypeError for a field of another type, and ValueError for one that is missing and for
/// parts that do not fit together.
Run set_state(const py::dict& state);

}  // namespace pendcore::bindings
