#include "bind_options.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "arguments.hpp"
#include "bind_events.hpp"
#include "simulate/checked_options.hpp"

namespace pendcore::bindings {
namespace {

/// Each of these takes the value of an option from Python.
struct Taken {
  const ParameterInfo& info;
  py::handle value;
  std::size_t n;  ///< links
  const char* name = info.name.data();

  void into(double& x) const { x = number(name, value); }
  void into(std::optional<double>& x) const { x = optional_number(name, value); }
  void into(long long& x) const { x = whole_number(name, value); }
  void into(bool& x) const { x = truth(name, value); }

  void into(std::string& text) const {
    const std::optional<std::string> word = valid_text();
    if (!word) throw py::type_error(name_and_value() + ": must be the name of a method");
    text = *word;
  }

  void into(std::optional<Store>& store) const {
    if (value.is_none()) return;
    const std::optional<std::string> word = valid_text();
    const std::optional<Store> found = word ? find_store(*word) : std::nullopt;
    if (!found) throw py::value_error(name_and_value() + ": " + std::string(must_be_store));
    store = found;
  }

  void into(Tolerance& tolerance) const {
    double alone = 0.0;
    if (take_plain(value, alone)) {
      tolerance.assign(1, alone);
    } else {
      tolerance = numbers(name, value, "a number or (" + std::to_string(2 * n) + ",)");
    }
  }

  void into(std::vector<double>& times) const {
    if (value.is_none()) return;
    times = numbers(name, value);
    if (times.empty()) {
      throw py::value_error(std::string(name) + ": is empty: must hold a time (s), or be left out");
    }
  }

  void into(std::vector<Event>& events) const {
    for (const py::handle event : value) events.push_back(make_event(event));
  }

  /// The value, unless it is no text, or text that no encoding has (a lone surrogate).
  std::optional<std::string> valid_text() const {
    try {
      if (py::isinstance<py::str>(value)) return value.cast<std::string>();
    } catch (const py::cast_error&) {
    }
    return std::nullopt;
  }
  std::string name_and_value() const {
    return std::string(name) + " = " + py::repr(value).cast<std::string>();
  }
};

py::array all(const std::vector<double>& numbers) {
  return copy(numbers, {static_cast<py::ssize_t>(numbers.size())});
}

/// The value of one of the options, for Python.
template <class Value>
py::object given(const Options& options, const Value& value) {
  if constexpr (std::same_as<Value, std::vector<Event>>) {
    return py::tuple();
  } else if constexpr (std::same_as<Value, std::optional<Store>>) {
    const bool is_usual = value.value_or(usual_store(options)) == usual_store(options);
    return is_usual ? py::object(py::none()) : string(store_name(*value));
  } else if constexpr (std::same_as<Value, Tolerance>) {
    return value.size() == 1 ? py::object(py::float_(value[0])) : all(value);
  } else if constexpr (std::same_as<Value, NumberList>) {
    return value.empty() ? py::object(py::none()) : all(value);
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

/// The text of a keyword. A cast would note the string in a table, to keep it alive.
std::string_view text_of(py::handle keyword) {
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(keyword.ptr(), &size);
  if (text == nullptr) throw py::error_already_set();
  return {text, static_cast<std::size_t>(size)};
}

}  // namespace

Options options_of(const py::dict& given, std::size_t n) {
  Options options;
  for (const auto& [key, value] : given) {
    const std::string_view name = text_of(key);
    const auto take = [&, &value = value](const auto& one) {
      if (one.info.name != name) return false;
      Taken{one.info, value, n}.into(options.*(one.field));
      return true;
    };
    // They are asked until one takes the value.
    const bool is_known =
        std::apply([&](const auto&... each) { return (take(each) || ...); }, Options::parameters);
    if (!is_known) throw py::type_error("no option of a run is called " + std::string(name));
  }
  return options;
}

py::dict as_python(const Options& options) {
  py::dict result;
  for_each_parameter(options, [&](const ParameterInfo& info, const auto& value) {
    result[string(info.name)] = given(options, value);
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
