#include "arguments.hpp"

#include <algorithm>

namespace pendcore::bindings {
namespace {

bool is_plain_number(py::handle value) {
  return PyFloat_Check(value.ptr()) || (PyLong_Check(value.ptr()) && !PyBool_Check(value.ptr()));
}

bool is_list_or_tuple(py::handle value) {
  return PyList_Check(value.ptr()) || PyTuple_Check(value.ptr());
}

std::span<PyObject* const> items_of(py::handle list_or_tuple) {
  return {PySequence_Fast_ITEMS(list_or_tuple.ptr()),
          static_cast<std::size_t>(PySequence_Fast_GET_SIZE(list_or_tuple.ptr()))};
}

/// NumPy's array itself, and none of its kin, which may mean something else by their numbers.
bool is_plain_array(py::handle value) {
  return Py_TYPE(value.ptr()) == py::detail::npy_api::get().PyArray_Type_;
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

[[noreturn]] void refuse_size(std::string_view name, const char* range) {
  PyErr_Clear();
  throw py::value_error(std::string(name) + ": is too large: must be " + range);
}

/// Refuses an integer beyond the range of doubles, and what has masked values: NumPy would make
/// objects of the one, and forget the masks of the other.
void refuse_what_numpy_takes(std::string_view name, py::handle value) {
  double ignored = 0.0;
  if (is_plain_number(value) && !take_plain(value, ignored)) refuse_size(name, "below 1.8e308");
  if (is_plain_array(value) || !py::detail::npy_api::get().PyArray_Check_(value.ptr())) return;
  if (!py::module_::import("numpy.ma").attr("is_masked")(value).cast<bool>()) return;
  throw py::value_error(
      std::string(name) +
      ": has masked values: must have a number everywhere: x.compressed() leaves masked ones out, "
      "x.filled(...) replaces them");
}

/// Any array-like of real numbers, or an empty optional where it is something else.
std::optional<Array> real_array(std::string_view name, py::handle value) {
  if (is_array_of_doubles(value)) return py::reinterpret_borrow<Array>(value);
  refuse_what_numpy_takes(name, value);
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

std::string name_and_value(std::string_view name, py::handle value) {
  return std::string(name) + " = " + py::repr(value).cast<std::string>();
}

void refuse_type(std::string_view name, py::handle value, std::string_view wanted) {
  throw py::type_error(name_and_value(name, value) + ": must be " + std::string(wanted));
}

double number(std::string_view name, py::handle value) {
  double plain = 0.0;
  if (take_plain(value, plain)) return plain;
  const auto array = real_array(name, value);
  if (!array || array->ndim() != 0) refuse_type(name, value, "a real number");
  return *array->data();
}

long long whole_number(std::string_view name, py::handle value) {
  if (PyBool_Check(value.ptr()) || !PyIndex_Check(value.ptr())) {
    refuse_type(name, value, "a whole number");
  }
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) throw py::error_already_set();
  const long long result = PyLong_AsLongLong(index.ptr());
  if (result == -1 && PyErr_Occurred() != nullptr) refuse_size(name, "below 2^63");
  return result;
}

bool truth(std::string_view name, py::handle value) {
  py::detail::make_caster<bool> caster;
  if (!caster.load(value, /*convert=*/false)) refuse_type(name, value, "True or False");
  return caster;
}

std::optional<std::string_view> utf8(py::handle text) {
  Py_ssize_t size = 0;
  const char* const found = PyUnicode_AsUTF8AndSize(text.ptr(), &size);
  if (found == nullptr) return std::nullopt;
  return std::string_view(found, static_cast<std::size_t>(size));
}

std::optional<std::string> text_of(py::handle value) {
  if (PyUnicode_Check(value.ptr()) == 0) return std::nullopt;
  if (const auto text = utf8(value)) return std::string(*text);
  PyErr_Clear();
  return std::nullopt;
}

std::vector<double> numbers(std::string_view name, py::handle value, const std::string& wanted,
                            std::size_t copies) {
  double alone = 0.0;
  if (take_plain(value, alone)) return std::vector<double>(copies, alone);
  if (is_list_or_tuple(value)) {
    std::vector<double> result(items_of(value).size());
    if (take_plain(value, result)) return result;
    for (PyObject* const item : items_of(value)) refuse_what_numpy_takes(name, item);
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
  if (x != -1.0 || PyErr_Occurred() == nullptr) return true;
  PyErr_Clear();  // an integer beyond the range of doubles
  return false;
}

bool take_plain(py::handle value, std::span<double> into) {
  if (is_list_or_tuple(value)) {
    const std::span<PyObject* const> items = items_of(value);
    if (items.size() != into.size()) return false;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (!take_plain(items[i], into[i])) return false;
    }
    return true;
  }
  if (!is_array_of_doubles(value)) return false;
  const auto array = py::reinterpret_borrow<Array>(value);
  if (array.ndim() != 1 || static_cast<std::size_t>(array.size()) != into.size()) return false;
  std::copy_n(array.data(), into.size(), into.begin());
  return true;
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

py::array copy(std::span<const double> numbers) { return copy(numbers, shape(numbers.size())); }

}  // namespace pendcore::bindings
