/// \file
/// A solution as Python holds it: with its scene, so that it can go on, and with the exception that
/// broke it off, if one did.
#pragma once

#include "arguments.hpp"
#include "pendcore/pendcore.hpp"

namespace pendcore::bindings {

struct Run {
  Scene scene;
  Solution solution;
  py::object error = py::none();
};

/// Calls Python about every 50 ms while the core computes without its lock: for Ctrl-C, and to show
/// the progress. An exception stops the run and is kept.
class PythonMonitor {
 public:
  explicit PythonMonitor(py::handle progress) : progress_(progress) {}
  bool operator()(double fraction);
  /// Puts the exception, and the status that it means, into the run.
  void close(Run& run) const;

 private:
  py::handle progress_;
  std::shared_ptr<py::object> error_ = std::make_shared<py::object>();
};

}  // namespace pendcore::bindings
