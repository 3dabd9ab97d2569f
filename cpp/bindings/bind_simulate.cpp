#include <algorithm>

#include "bind_events.hpp"
#include "python_monitor.hpp"
#include "start.hpp"

namespace pendcore::bindings {
namespace {

Store store_named(py::handle store, bool has_times) {
  if (store.is_none()) return has_times ? Store::times : Store::dense;
  const auto name = py::str(store).cast<std::string>();
  const auto* const found = std::ranges::find(store_names, name);
  if (found != store_names.end()) return static_cast<Store>(found - store_names.begin());
  throw py::value_error("store = " + py::repr(store).cast<std::string>() +
                        ": must be \"dense\", \"steps\", \"times\" or \"end\"");
}

std::string method_named(py::handle method) {
  try {
    if (py::isinstance<py::str>(method)) return method.cast<std::string>();
  } catch (const py::cast_error&) {  // a string that is no text
  }
  throw py::type_error("method = " + py::repr(method).cast<std::string>() +
                       ": must be the name of a method");
}

Run simulate_run(const py::object& python_scene, py::handle q0, py::handle qd0, py::handle t0,
                 py::handle t_end, py::handle method, py::handle rtol, py::handle atol,
                 py::handle t_eval, py::handle store, py::handle first_step, py::handle max_step,
                 py::handle step, py::handle max_steps, py::handle time_limit,
                 const py::sequence& events, py::handle ledger, py::handle compensated,
                 py::handle progress, py::handle warn) {
  const auto& scene = python_scene.cast<const Scene&>();
  const std::size_t n = scene.links.size();
  const std::string one_a_component = "a number or (" + std::to_string(2 * n) + ",)";
  PythonMonitor monitor(progress);
  Options options;
  options.method = method_named(method);
  options.rtol = numbers("rtol", rtol, one_a_component);
  options.atol = numbers("atol", atol, one_a_component);
  if (!t_eval.is_none()) {
    options.t_eval = numbers("t_eval", t_eval);
    if (options.t_eval.empty()) {
      throw py::value_error("t_eval: is empty: must hold a time (s), or be left out");
    }
  }
  options.store = store_named(store, !t_eval.is_none());
  options.first_step = optional_number("first_step", first_step);
  options.max_step = number("max_step", max_step);
  options.step = optional_number("step", step);
  options.max_steps = whole_number("max_steps", max_steps);
  options.time_limit = optional_number("time_limit", time_limit).value_or(options.time_limit);
  for (const py::handle event : events) options.events.push_back(make_event(event));
  options.ledger = truth("ledger", ledger);
  options.compensated = truth("compensated", compensated);
  options.monitor = monitor;
  const Start start = start_of(scene, q0, qd0, t0, t_end, warn);
  Run run{.scene = scene,
          .solution = {},
          .python_scene = python_scene,
          .event_functions = functions_of(events)};
  {
    const py::gil_scoped_release without_lock;
    run.solution = simulate(run.scene, start.q0, start.qd0, start.t0, start.t_end, options);
  }
  monitor.close(run);
  return run;
}

}  // namespace

void bind_simulate(py::module_& module) {
  module.def("simulate", &simulate_run, py::arg("scene"), py::arg("q0"), py::arg("qd0"),
             py::arg("t0"), py::arg("t_end"), py::arg("method"), py::arg("rtol"), py::arg("atol"),
             py::arg("t_eval"), py::arg("store"), py::arg("first_step"), py::arg("max_step"),
             py::arg("step"), py::arg("max_steps"), py::arg("time_limit"), py::arg("events"),
             py::arg("ledger"), py::arg("compensated"), py::arg("progress"), py::arg("warn"));
}

}  // namespace pendcore::bindings
