#include "bind_events.hpp"

#include <pybind11/stl.h>

#include "arguments.hpp"
#include "python_function.hpp"

namespace pendcore::bindings {
namespace {

template <class Value>
Value value_of(const py::dict& values, const char* name) {
  return values[name].cast<Value>();
}

std::optional<int> given(const py::dict& values, const char* name) {
  return value_of<std::optional<int>>(values, name);
}

EventFunction make_function(const std::string& kind, const py::dict& values) {
  if (kind == events::JointAngle::kind) {
    return events::JointAngle{.joint = value_of<int>(values, "joint"),
                              .value = value_of<double>(values, "value"),
                              .every_turn = value_of<bool>(values, "every_turn")};
  }
  if (kind == events::LinkAngle::kind) {
    return events::LinkAngle{.link = value_of<int>(values, "link"),
                             .value = value_of<double>(values, "value"),
                             .every_turn = value_of<bool>(values, "every_turn")};
  }
  if (kind == events::RateZero::kind) {
    return events::RateZero{.joint = given(values, "joint"), .link = given(values, "link")};
  }
  if (kind == events::TipLine::kind) {
    return events::TipLine{.point = value_of<std::array<double, 2>>(values, "point"),
                           .normal = value_of<std::array<double, 2>>(values, "normal")};
  }
  if (kind == events::Function::kind) {
    return events::Function{.f = event_function(values["f"]),
                            .samples = value_of<int>(values, "samples"),
                            .max_step = value_of<double>(values, "max_step")};
  }
  throw py::value_error("events: kind = \"" + kind + "\": there is no such event");
}

void put(py::dict& values, const events::JointAngle& event) {
  values["joint"] = event.joint;
  values["value"] = event.value;
  values["every_turn"] = event.every_turn;
}

void put(py::dict& values, const events::LinkAngle& event) {
  values["link"] = event.link;
  values["value"] = event.value;
  values["every_turn"] = event.every_turn;
}

void put(py::dict& values, const events::RateZero& event) {
  values["joint"] = event.joint;
  values["link"] = event.link;
}

void put(py::dict& values, const events::TipLine& event) {
  values["point"] = py::tuple(py::cast(event.point));
  values["normal"] = py::tuple(py::cast(event.normal));
}

void put(py::dict& values, const events::Function& event) {
  values["samples"] = event.samples;
  values["max_step"] = event.max_step;
}

}  // namespace

Event make_event(py::handle kind_and_values) {
  const auto [kind, values] = kind_and_values.cast<std::pair<std::string, py::dict>>();
  return {.function = make_function(kind, values),
          .direction = value_of<int>(values, "direction"),
          .terminal = value_of<long long>(values, "terminal"),
          .name = value_of<std::string>(values, "name")};
}

py::tuple kind_and_values(const Event& event, const py::object& f) {
  py::dict values;
  if (!f.is_none()) values["f"] = f;
  std::visit([&](const auto& one) { put(values, one); }, event.function);
  values["direction"] = event.direction;
  values["terminal"] = event.terminal;
  values["name"] = event.name;
  const std::string_view kind =
      std::visit([](const auto& one) { return one.kind; }, event.function);
  return py::make_tuple(string(kind), values);
}

py::tuple saved_event(const Event& event, std::size_t i) {
  if (std::holds_alternative<events::Function>(event.function)) {
    throw py::type_error(event_name(event, i) +
                         ": is a function: a run that looks for it cannot be pickled or saved");
  }
  return kind_and_values(event, py::none());
}

py::list functions_of(const py::sequence& events) {
  py::list functions;
  for (const py::handle event : events) {
    const auto [kind, values] = event.cast<std::pair<std::string, py::dict>>();
    functions.append(values.contains("f") ? py::object(values["f"]) : py::object(py::none()));
  }
  return functions;
}

void bind_events(py::module_& module) {
  module.def(
      "check_event",
      [](const std::string& where, py::handle kind_and_values) {
        check_event(where, make_event(kind_and_values), std::numeric_limits<int>::max());
      },
      py::arg("where"), py::arg("kind_and_values"),
      "Raise a ValueError that begins with `where` for a value that is out of its range.");
}

}  // namespace pendcore::bindings
