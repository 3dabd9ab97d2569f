#include "arguments.hpp"

#include <algorithm>
#include <cmath>

namespace pendcore::bindings {
namespace {

[[noreturn]] void refuse_type(const char* name, py::handle value, const char* wanted) {
  throw py::type_error(std::string(name) + " = " + py::repr(value).cast<std::string>() +
                       ": must be " + wanted);
}

bool is_plain_number(py::handle value) {
  return PyFloat_Check(value.ptr()) || (PyLong_Check(value.ptr()) && !PyBool_Check(value.ptr()));
}

[[noreturn]] void refuse_size(const char* name, const char* range) {
  PyErr_Clear();
  throw py::value_error(std::string(name) + ": is too large: must be " + range);
}

double plain_number(const char* name, py::handle value) {
  const double x = PyFloat_AsDouble(value.ptr());
  if (x == -1.0 && PyErr_Occurred() != nullptr) refuse_size(name, "below 1.8e308");
  return x;
}

/// NumPy's array itself, and none of its kin, which may mean something else by their numbers.
bool is_plain_array(py::handle value) {
  return Py_TYPE(value.ptr()) == py::detail::npy_api::get().PyArray_Type_;
}

void refuse_masked(const char* name, py::handle value) {
  if (is_plain_array(value) || !py::detail::npy_api::get().PyArray_Check_(value.ptr())) return;
  if (!py::module_::import("numpy.ma").attr("is_masked")(value).cast<bool>()) return;
  throw py::value_error(
      std::string(name) +
      ": has masked values: must have a number everywhere: x.compressed() leaves masked ones out, "
      "x.filled(...) replaces them");
}

/// An array that needs no conversion. The same question to py::array_t makes a new dtype each time.
bool is_array_of_doubles(py::handle value) {
  if (!is_plain_array(value)) return false;
  const auto* const array = py::detail::array_proxy(value.ptr());
  const auto type = py::reinterpret_borrow<py::dtype>(array->descr);
  constexpr int plain =
      py::detail::npy_api::NPY_ARRAY_C_CONTIGUOUS_ | py::detail::npy_api::NPY_ARRAY_ALIGNED_;
  return type.num() == py::detail::npy_api::NPY_DOUBLE_ && type.byteorder() == '=' &&
         (array->flags & plain) == plain;
}

/// Any array-like of real numbers, or an empty optional where it is something else.
std::optional<Array> real_array(const char* name, py::handle value) {
  if (is_array_of_doubles(value)) return py::reinterpret_borrow<Array>(value);
  refuse_masked(name, value);
  if (py::isinstance<py::str>(value) || py::isinstance<py::bytes>(value)) return std::nullopt;
  const py::array any = py::array::ensure(value);
  if (!any) {
    PyErr_Clear();
    return std::nullopt;
  }
  const char kind = any.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') return std::nullopt;
  return Array::ensure(any);
}

}  // namespace

double number(const char* name, py::handle value) {
  if (is_plain_number(value)) return plain_number(name, value);
  const auto array = real_array(name, value);
  if (!array || array->ndim() != 0) refuse_type(name, value, "a real number");
  return *array->data();
}

std::optional<double> optional_number(const char* name, py::handle value) {
  if (value.is_none()) return std::nullopt;
  return number(name, value);
}

long long whole_number(const char* name, py::handle value) {
  if (PyBool_Check(value.ptr()) || !PyIndex_Check(value.ptr())) {
    refuse_type(name, value, "a whole number");
  }
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) throw py::error_already_set();
  const long long result = PyLong_AsLongLong(index.ptr());
  if (result == -1 && PyErr_Occurred() != nullptr) refuse_size(name, "below 2^63");
  return result;
}

bool truth(const char* name, py::handle value) {
  py::detail::make_caster<bool> caster;
  if (!caster.load(value, /*convert=*/false)) refuse_type(name, value, "True or False");
  return caster;
}

std::vector<double> numbers(const char* name, py::handle value, const std::string& wanted,
                            std::size_t copies) {
  if (is_plain_number(value)) return std::vector<double>(copies, plain_number(name, value));
  if (PyList_Check(value.ptr()) || PyTuple_Check(value.ptr())) {
    const auto size = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(value.ptr()));
    PyObject* const* items = PySequence_Fast_ITEMS(value.ptr());
    std::vector<double> result(size);
    std::size_t i = 0;
    while (i < size && is_plain_number(items[i])) {
      result[i] = plain_number(name, items[i]);
      ++i;
    }
    if (i == size) return result;
    for (; i < size; ++i) refuse_masked(name, items[i]);
  }
  const auto array = real_array(name, value);
  if (!array) refuse_type(name, value, "real numbers");
  if (array->ndim() == 0) return std::vector<double>(copies, *array->data());
  if (array->ndim() != 1) {
    throw py::value_error(std::string(name) + ": shape " +
                          py::str(array->attr("shape")).cast<std::string>() + ": must be " +
                          wanted);
  }
  return {array->data(), array->data() + array->size()};
}

bool take_plain(py::handle value, double& x) {
  if (!is_plain_number(value)) return false;
  x = PyFloat_AsDouble(value.ptr());
  if (x == -1.0 && PyErr_Occurred() != nullptr) {  // an integer beyond the range of doubles
    PyErr_Clear();
    return false;
  }
  return std::isfinite(x);
}

bool take_plain(py::handle value, std::span<double> into) {
  if (PyList_Check(value.ptr()) || PyTuple_Check(value.ptr())) {
    const auto size = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(value.ptr()));
    if (size != into.size()) return false;
    PyObject* const* items = PySequence_Fast_ITEMS(value.ptr());
    for (std::size_t i = 0; i < size; ++i) {
      if (!take_plain(items[i], into[i])) return false;
    }
    return true;
  }
  if (!is_array_of_doubles(value)) return false;
  const auto array = py::reinterpret_borrow<Array>(value);
  if (array.ndim() != 1 || static_cast<std::size_t>(array.size()) != into.size()) return false;
  std::copy_n(array.data(), into.size(), into.begin());
  return std::ranges::all_of(into, [](double x) { return std::isfinite(x); });
}

py::array view(const std::vector<double>& numbers, std::vector<py::ssize_t> shape,
               py::handle owner) {
  Array array(std::move(shape), numbers.data(), owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array copy(std::span<const double> numbers, std::vector<py::ssize_t> shape) {
  return Array(std::move(shape), numbers.data());
}

}  // namespace pendcore::bindings
