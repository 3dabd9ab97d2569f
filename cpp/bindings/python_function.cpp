#include "python_function.hpp"

#include <algorithm>

#include "arguments.hpp"

namespace pendcore::bindings {
namespace {

std::string name_of(const char* kind, py::handle function) {
  const py::object name = py::getattr(function, "__qualname__", py::repr(function));
  return kind + py::str(name).cast<std::string>() + "(t, q, qd)";
}

void call(double t, int n, const double* q, const double* qd, double* forces, void* data) {
  const py::gil_scoped_acquire lock;
  const py::handle function(static_cast<PyObject*>(data));
  const py::object result = function(t, Array(n, q), Array(n, qd));
  const auto size = static_cast<std::size_t>(n);
  if (take_plain(result, std::span(forces, size))) return;
  const std::string name = name_of("User: ", function);
  const std::string wanted =
      "(" + std::to_string(n) + ",), the generalised forces of the absolute angles (N m)";
  const std::vector<double> values = numbers(name, result, wanted);
  if (values.size() != size) {
    throw py::value_error(name + ": shape (" + std::to_string(values.size()) + ",): must be " +
                          wanted);
  }
  std::ranges::copy(values, forces);
}

}  // namespace

CompiledUser effect_of_function(py::handle function, const std::vector<double>& breaks) {
  return {.address = reinterpret_cast<std::uintptr_t>(&call),
          .data = reinterpret_cast<std::uintptr_t>(function.ptr()),
          .breaks = breaks};
}

std::function<double(double, std::span<const double>, std::span<const double>)> event_function(
    py::handle function) {
  return [function](double t, std::span<const double> q, std::span<const double> qd) {
    const py::gil_scoped_acquire lock;
    const auto n = static_cast<py::ssize_t>(q.size());
    const py::object result = function(t, Array(n, q.data()), Array(n, qd.data()));
    if (PyFloat_CheckExact(result.ptr()) != 0) return PyFloat_AS_DOUBLE(result.ptr());
    return number(name_of("Function: ", function), result);
  };
}

py::object python_exception(const py::error_already_set& raised) {
  if (raised.trace()) PyException_SetTraceback(raised.value().ptr(), raised.trace().ptr());
  return raised.value();
}

py::object python_exception(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const py::error_already_set& raised) {
    return python_exception(raised);
  } catch (const py::builtin_exception& raised) {
    raised.set_error();
  } catch (const std::domain_error& raised) {
    PyErr_SetString(PyExc_ValueError, raised.what());
  } catch (const std::exception& raised) {
    PyErr_SetString(PyExc_RuntimeError, raised.what());
  }
  return py::error_already_set().value();
}

}  // namespace pendcore::bindings
