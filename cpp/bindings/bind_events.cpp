#include <type_traits>

#include "described.hpp"
#include "kind_and_values.hpp"
#include "python_function.hpp"

namespace pendcore::bindings {
namespace {

template <class Visit, class... Kinds>
void for_each_event_kind(std::type_identity<std::variant<Kinds...>> /*all*/, const Visit& visit) {
  (visit(Kinds{}), ...);
}

}  // namespace

Event make_event(py::handle kind_and_values) {
  const auto pair = kind_and_values.cast<std::pair<std::string, py::dict>>();
  const auto& values = pair.second;
  Event event;
  fill(event, values);
  bool is_known = false;
  for_each_event_kind(std::type_identity<EventFunction>(), [&]<class Kind>(Kind given) {
    if (Kind::kind != pair.first) return;
    is_known = true;
    fill(given, values);
    if constexpr (std::same_as<Kind, events::Function>) given.f = event_function(values["f"]);
    event.function = std::move(given);
  });
  if (is_known) return event;
  throw py::value_error("events: kind = \"" + pair.first + "\": there is no such event");
}

py::tuple kind_and_values(const Event& event, const py::object& f) {
  py::dict values = std::visit([](const auto& one) { return values_of(one); }, event.function);
  if (!f.is_none()) values["f"] = f;
  values.attr("update")(values_of(event));
  return py::make_tuple(event.kind(), values);
}

py::list functions_of(const py::sequence& events) {
  py::list functions;
  for (const py::handle event : events) {
    functions.append(event.cast<KindAndValues>().second.attr("get")("f"));
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
