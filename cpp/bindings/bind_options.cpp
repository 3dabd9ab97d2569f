#include "bind_options.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "arguments.hpp"
#include "kind_and_values.hpp"
#include "simulate/checked_options.hpp"

namespace pendcore::bindings {
namespace {

/// Takes the value of an option from Python, for a chain of n links.
template <class Value>
void take_option(std::string_view name, py::handle value, std::size_t n, Value& into) {
  if constexpr (std::same_as<Value, std::string>) {
    std::optional<std::string> word = text_of(value);
    if (!word) refuse_type(name, value, "the name of a method");
    into = *std::move(word);
  } else if constexpr (std::same_as<Value, std::optional<Store>>) {
    if (value.is_none()) return;
    into = find_store(text_of(value).value_or(""));
    if (!into) {
      throw py::value_error(name_and_value(name, value) + ": " + std::string(must_be_store));
    }
  } else if constexpr (std::same_as<Value, Tolerance>) {
    double alone = 0.0;
    if (take_plain(value, alone)) {
      into.assign(1, alone);
    } else {
      into = numbers(name, value, "a number or (" + std::to_string(2 * n) + ",)");
    }
  } else if constexpr (std::same_as<Value, NumberList>) {
    if (value.is_none()) return;
    into = numbers(name, value);
    if (into.empty()) {
      throw py::value_error(std::string(name) + ": is empty: must hold a time (s), or be left out");
    }
  } else if constexpr (std::same_as<Value, std::vector<Event>>) {
    for (const py::handle event : value) into.push_back(make_event(event));
  } else {
    take(name, value, into);
  }
}

template <class Value>
py::object given(const Options& options, const Value& value) {
  if constexpr (std::same_as<Value, std::vector<Event>>) {
    return py::tuple();
  } else if constexpr (std::same_as<Value, std::optional<Store>>) {
    const bool is_usual = value.value_or(usual_store(options)) == usual_store(options);
    return is_usual ? py::object(py::none()) : py::object(py::str(store_name(*value)));
  } else if constexpr (std::same_as<Value, Tolerance>) {
    return value.size() == 1 ? py::object(py::float_(value[0])) : copy(value);
  } else if constexpr (std::same_as<Value, NumberList>) {
    return value.empty() ? py::object(py::none()) : copy(value);
  } else {
    return py::cast(value);
  }
}

/// The type annotation of an option in Python.
constexpr std::string_view annotation(const double& /*x*/) { return "float"; }
constexpr std::string_view annotation(const std::optional<double>& /*x*/) { return "float | None"; }
constexpr std::string_view annotation(const long long& /*x*/) { return "int"; }
constexpr std::string_view annotation(const bool& /*x*/) { return "bool"; }
constexpr std::string_view annotation(const std::string& /*x*/) { return "str"; }
constexpr std::string_view annotation(const std::optional<Store>& /*x*/) { return "str | None"; }
constexpr std::string_view annotation(const Tolerance& /*x*/) { return "npt.ArrayLike"; }
constexpr std::string_view annotation(const std::vector<double>& /*x*/) { return "npt.ArrayLike"; }
constexpr std::string_view annotation(const std::vector<Event>& /*x*/) { return "Iterable[Event]"; }

py::dict descriptor(const ParameterInfo& info, std::string_view annotation, py::object usual) {
  const bool adds_none = usual.is_none() && annotation.find("None") == std::string_view::npos;
  py::dict result;
  result["name"] = info.name;
  result["annotation"] = std::string(annotation) + (adds_none ? " | None" : "");
  result["type"] = info.type;
  result["unit"] = info.unit;
  result["default"] = std::move(usual);
  result["range"] = info.range == Range::any ? "" : text(info.range);
  result["if_none"] = info.if_none;
  result["sentence"] = info.sentence;
  result["chosen_for_error"] = info.chosen_for_error;
  result["limits_every_method"] = info.limits_every_method;
  return result;
}

}  // namespace

Options options_of(const py::dict& given, std::size_t n) {
  Options options;
  for (const auto& [key, value] : given) {
    const auto keyword = utf8(key);
    if (!keyword) throw py::error_already_set();
    const std::string_view name = *keyword;
    const auto take_one = [&, &value = value](const auto& one) {
      if (one.info.name != name) return false;
      take_option(name, value, n, options.*(one.field));
      return true;
    };
    // They are asked until one takes the value.
    const bool is_known = std::apply([&](const auto&... each) { return (take_one(each) || ...); },
                                     Options::parameters);
    if (!is_known) throw py::type_error("no option of a run is called " + std::string(name));
  }
  return options;
}

py::dict as_python(const Options& options) {
  py::dict result;
  for_each_parameter(options, [&](const ParameterInfo& info, const auto& value) {
    result[py::str(info.name)] = given(options, value);
  });
  return result;
}

void bind_options(py::module_& module) {
  module.def("run_options", [] {
    py::list result;
    const Options usual;
    for_each_parameter(usual, [&](const ParameterInfo& info, const auto& value) {
      result.append(descriptor(info, annotation(value), given(usual, value)));
    });
    return result;
  });
}

}  // namespace pendcore::bindings
