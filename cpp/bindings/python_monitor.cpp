#include "python_monitor.hpp"

#include <utility>

#include "pendcore/solution.hpp"
#include "python_function.hpp"

namespace pendcore::bindings {

bool PythonMonitor::operator()(double fraction) {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() == 0) {
    if (progress_.is_none()) return true;
    const py::object done = py::float_(fraction);
    PyObject* result = PyObject_CallOneArg(progress_.ptr(), done.ptr());
    Py_XDECREF(result);
    if (result != nullptr) return true;
  }
  error_ = python_exception(py::error_already_set());
  return false;
}

void PythonMonitor::close(Run& run) {
  Solution& solution = run.solution;
  run.error = close(solution.status, solution.message, solution.error);
}

py::object PythonMonitor::close(Status& status, std::string& message, std::exception_ptr& error) {
  if (error) error_ = python_exception(std::exchange(error, nullptr));
  if (!error_) {
    // Ctrl-C came after the core last looked for it: the run is complete, and is not lost.
    if (PyErr_CheckSignals() == 0) return py::none();
    error_ = python_exception(py::error_already_set());
    return error_;
  }
  const bool stopped = PyErr_GivenExceptionMatches(error_.ptr(), PyExc_KeyboardInterrupt) != 0;
  const std::size_t sentence = text(status).sentence.size();
  status = stopped ? Status::interrupted : Status::callback_error;
  message.replace(0, sentence, text(status).sentence);
  return error_;
}

}  // namespace pendcore::bindings
