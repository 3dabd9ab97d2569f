/// \file
/// Calls Python about every 50 ms while the core computes without Python's lock: for Ctrl-C, and to
/// show the progress. An exception stops the run and is kept, like an exception in a user's
/// function.
#pragma once

#include <memory>

#include "run.hpp"

namespace pendcore::bindings {

class PythonMonitor {
 public:
  explicit PythonMonitor(py::handle progress) : progress_(progress) {}

  /// What the core calls: false stops the run.
  bool operator()(double fraction);

  /// Puts the exception, and the status that it means, into the run.
  void close(Run& run) const;
  /// The exception, or None; the status that it means, and its sentence, become the run's.
  py::object close(Status& status, std::string& message, std::exception_ptr& error) const;

 private:
  void keep_error() const;

  py::handle progress_;
  std::shared_ptr<py::object> error_ = std::make_shared<py::object>();  // shared by copies
};

}  // namespace pendcore::bindings
