#include "event_state.hpp"

#include <cmath>

#include "arguments.hpp"
#include "bind_events.hpp"
#include "pendcore/solution.hpp"

namespace pendcore::bindings {
namespace {

py::object json(const char* function, const py::object& given) {
  return py::module_::import("json").attr(function)(given);
}

std::vector<double> column(const py::dict& fields, const char* name) {
  return numbers(name, fields[name]);
}

}  // namespace

void put_events(py::dict& fields, const Solution& solution) {
  py::list events;
  for (std::size_t i = 0; i < solution.options.events.size(); ++i) {
    events.append(saved_event(solution.options.events[i], i));
  }
  fields["events"] = json("dumps", events);
  std::vector<double> event, t, direction, y, y_before;
  for (const FoundEvent& one : solution.found) {
    event.push_back(one.event);
    t.push_back(one.t);
    direction.push_back(one.direction);
    y.insert(y.end(), one.y.begin(), one.y.end());
    y_before.insert(y_before.end(), one.y_before.begin(), one.y_before.end());
    y_before.resize(y.size(), std::nan(""));  // where the state does not jump
  }
  const auto put = [&](const char* name, const std::vector<double>& numbers) {
    fields[name] = copy(numbers, {static_cast<py::ssize_t>(numbers.size())});
  };
  put("found_event", event);
  put("found_t", t);
  put("found_direction", direction);
  put("found_y", y);
  put("found_y_before", y_before);
}

void take_events(const py::dict& fields, Solution& solution) {
  std::vector<Event>& events = solution.options.events;
  const py::object listed = json("loads", fields["events"]);
  for (const py::handle event : listed) {
    const auto kind = event.cast<std::pair<std::string, py::object>>().first;
    if (kind == events::Function::kind) {
      throw py::value_error("events: " + kind + ": a function cannot come from a file");
    }
    events.push_back(make_event(event));
    check_event("events: ", events.back(), solution.n);
  }
  const std::vector<double> event = column(fields, "found_event");
  const std::vector<double> t = column(fields, "found_t");
  const std::vector<double> direction = column(fields, "found_direction");
  const std::vector<double> y = column(fields, "found_y");
  const std::vector<double> y_before = column(fields, "found_y_before");
  const std::size_t count = event.size();
  const std::size_t n = 2 * static_cast<std::size_t>(solution.n);
  bool fits = t.size() == count && direction.size() == count && y.size() == count * n &&
              y_before.size() == count * n && solution.resumable_found <= count;
  for (std::size_t i = 0; fits && i < count; ++i) {
    fits = event[i] >= 0.0 && event[i] < static_cast<double>(events.size()) &&
           std::abs(direction[i]) <= 1.0;
    if (!fits) break;
    const double* const state = y.data() + i * n;
    const double* const before = y_before.data() + i * n;
    solution.found.push_back({.event = static_cast<int>(event[i]),
                              .t = t[i],
                              .direction = static_cast<int>(direction[i]),
                              .y = {state, state + n},
                              .y_before = {}});
    if (!std::isnan(*before)) solution.found.back().y_before.assign(before, before + n);
  }
  if (!fits) throw py::value_error("the events of this solution do not fit together");
}

}  // namespace pendcore::bindings
