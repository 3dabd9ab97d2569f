#include "bind_options.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "arguments.hpp"
#include "bind_events.hpp"

namespace pendcore::bindings {
namespace {

/// Each of these takes the value of an option from Python.
struct Taken {
  const char* name;
  py::handle value;
  std::size_t n;  ///< links

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

  void into(std::vector<double>& tolerances) const {
    double alone = 0.0;
    if (take_plain(value, alone)) {
      tolerances.assign(1, alone);
      return;
    }
    tolerances = numbers(name, value, "a number or (" + std::to_string(2 * n) + ",)");
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

  void times_into(std::vector<double>& times) const {
    if (value.is_none()) return;
    times = numbers(name, value);
    if (times.empty()) {
      throw py::value_error(std::string(name) + ": is empty: must hold a time (s), or be left out");
    }
  }
};

template <class Option>
void take(Options& options, py::handle value, std::size_t n) {
  const Taken taken{Option::info.name.data(), value, n};
  if constexpr (std::same_as<Option, TEvalOption>) {
    taken.times_into(options.t_eval);
  } else {
    taken.into(options.*Option::field);
  }
}

py::array all(const std::vector<double>& numbers) {
  return copy(numbers, {static_cast<py::ssize_t>(numbers.size())});
}

template <class Option>
py::object given(const Options& options) {
  const auto& value = options.*Option::field;
  if constexpr (std::same_as<Option, EventsOption>) {
    return py::tuple();
  } else if constexpr (std::same_as<Option, StoreOption>) {
    const bool is_usual = value.value_or(usual_store(options)) == usual_store(options);
    return is_usual ? py::object(py::none()) : string(store_name(*value));
  } else if constexpr (std::same_as<Option, TEvalOption>) {
    return value.empty() ? py::object(py::none()) : all(value);
  } else if constexpr (std::same_as<decltype(value), const std::vector<double>&>) {
    return value.size() == 1 ? py::object(py::float_(value[0])) : all(value);
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
constexpr std::string_view annotation(const std::vector<double>& /*x*/) { return "npt.ArrayLike"; }
constexpr std::string_view annotation(const std::vector<Event>& /*x*/) { return "Iterable[Event]"; }

template <class Field>
inline constexpr bool is_number =
    std::same_as<Field, double> || std::same_as<Field, std::optional<double>> ||
    std::same_as<Field, long long> || std::same_as<Field, std::vector<double>>;

template <class Option>
py::dict descriptor(const Options& usual) {
  const auto& value = usual.*Option::field;
  const bool is_none = given<Option>(usual).is_none();
  std::string annotated(annotation(value));
  if (is_none && annotated.find("None") == std::string::npos) annotated += " | None";
  constexpr bool has_range =
      is_number<std::remove_cvref_t<decltype(value)>> && !std::same_as<Option, TEvalOption>;
  py::dict result;
  result["name"] = Option::info.name;
  result["annotation"] = annotated;
  result["type"] = Option::info.type;
  result["unit"] = Option::info.unit;
  result["default"] = given<Option>(usual);
  result["range"] = has_range ? in_words(Option::info.range) : "";
  result["if_none"] = Option::info.if_none;
  result["sentence"] = Option::info.sentence;
  result["chosen_for_error"] = Option::info.chosen_for_error;
  result["limits_every_method"] = Option::info.limits_every_method;
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
    const bool is_known = Options::any_of([&, &value = value]<class Option>() {
      if (Option::info.name != name) return false;
      take<Option>(options, value, n);
      return true;
    });
    if (!is_known) throw py::type_error("no option of a run is called " + std::string(name));
  }
  return options;
}

py::dict as_python(const Options& options) {
  py::dict result;
  Options::for_each(
      [&]<class Option>() { result[string(Option::info.name)] = given<Option>(options); });
  return result;
}

void bind_options(py::module_& module) {
  module.def("run_options", [] {
    py::list result;
    const Options usual;
    Options::for_each([&]<class Option>() { result.append(descriptor<Option>(usual)); });
    return result;
  });
}

}  // namespace pendcore::bindings
