/// \file
/// Structures with descriptors (descriptor.hpp) as dictionaries of Python, and back: effects and
/// their parts, events.
#pragma once

#include <pybind11/stl.h>

#include "arguments.hpp"
#include "pendcore/effects/effect.hpp"

namespace pendcore::bindings {

template <class Struct>
py::dict values_of(const Struct& given);

/// Sequences become tuples, a part a dictionary, and what is not there None.
template <class Value>
py::object python(const Value& value) {
  if constexpr (OptionalPart<Value>) {
    return value ? py::object(values_of(*value)) : py::object(py::none());
  } else if constexpr (!std::same_as<Value, std::string> && requires { value.begin(); }) {
    return py::tuple(py::cast(value));
  } else {
    return py::cast(value);
  }
}

/// All parameters by their names.
template <class Struct>
py::dict values_of(const Struct& given) {
  py::dict result;
  for_each_parameter(given, [&](const ParameterInfo& info, const auto& value) {
    result[py::str(info.name)] = python(value);
  });
  return result;
}

/// Takes the parameters that are given by their names. An error names the parameter after `where`.
template <class Struct>
void fill(Struct& filled, const py::dict& values, const std::string& where = "") {
  for_each_parameter(filled, [&]<class Value>(const ParameterInfo& info, Value& value) {
    const std::string name = where + std::string(info.name);
    const py::handle given = PyDict_GetItemWithError(values.ptr(), py::str(info.name).ptr());
    if (!given) {
      if (info.required) throw py::value_error(name + ": is missing");
      return;
    }
    if constexpr (OptionalPart<Value>) {
      value.reset();
      if (!given.is_none())
        fill(value.emplace(), py::dict(py::reinterpret_borrow<py::object>(given)), name + ".");
    } else {
      take(name, given, value);
    }
  });
}

}  // namespace pendcore::bindings
