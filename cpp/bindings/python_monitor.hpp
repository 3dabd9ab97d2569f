/// \file
/// Calls Python about every 50 ms while the core computes without Python's lock: for Ctrl-C, and to
/// show the progress. An exception stops the run and is kept, like an exception in a user's
/// function.
#pragma once

#include <functional>

#include "run.hpp"

namespace pendcore::bindings {

class PythonMonitor {
 public:
  explicit PythonMonitor(py::handle progress) : progress_(progress) {}

  PythonMonitor(const PythonMonitor&) = delete;  // what it kept would stay with the copy
  PythonMonitor& operator=(const PythonMonitor&) = delete;

  /// What the core gets: it may copy that, and every copy calls this object.
  Monitor for_core() { return std::ref(*this); }
  /// False stops the run.
  bool operator()(double fraction);

  /// Puts the exception, and the status that it means, into the run.
  void close(Run& run);
  /// The exception, or None; the status that it means, and its sentence, become the run's.
  py::object close(Status& status, std::string& message, std::exception_ptr& error);

 private:
  py::handle progress_;
  py::object error_;
};

}  // namespace pendcore::bindings
