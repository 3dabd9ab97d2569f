#include "python_monitor.hpp"

#include <utility>

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
  keep_error();
  return false;
}

void PythonMonitor::keep_error() const {
  const py::error_already_set error;
  *error_ = error.value();
  if (error.trace()) PyException_SetTraceback(error_->ptr(), error.trace().ptr());
}

void PythonMonitor::close(Run& run) const {
  Solution& solution = run.solution;
  if (solution.error) *error_ = python_exception(std::exchange(solution.error, nullptr));
  // Ctrl-C after the core has looked for it last: the run is whole, and is not lost.
  const bool is_whole = !*error_;
  if (is_whole && PyErr_CheckSignals() == 0) return;
  if (is_whole) keep_error();
  run.error = *error_;
  if (is_whole) return;
  const bool stopped = PyErr_GivenExceptionMatches(run.error.ptr(), PyExc_KeyboardInterrupt) != 0;
  const std::size_t sentence = text(solution.status).sentence.size();
  solution.status = stopped ? Status::interrupted : Status::callback_error;
  solution.message.replace(0, sentence, text(solution.status).sentence);
}

}  // namespace pendcore::bindings
