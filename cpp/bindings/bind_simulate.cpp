#include <memory>
#include <utility>

#include "bind_options.hpp"
#include "kind_and_values.hpp"
#include "pendcore/simulate.hpp"
#include "python_monitor.hpp"
#include "simulate/checked_options.hpp"
#include "simulate/step_watch.hpp"
#include "start.hpp"

namespace pendcore::bindings {
namespace {

std::unique_ptr<Run> simulate_run(const py::object& python_scene, py::handle q0, py::handle qd0,
                                  py::handle t0, py::handle t_end, const py::dict& given,
                                  py::handle progress, py::handle warn, py::handle watch) {
  const auto& scene = python_scene.cast<const Scene&>();
  PythonMonitor monitor(progress);
  Options options = options_of(given, scene.links.size());
  options.monitor = monitor.for_core();
  // As a pointer, None takes pybind11 a microsecond: it looks for a foreign class first.
  if (!watch.is_none()) {
    auto& keeping = watch.cast<KeepingWatch&>();
    keeping.keep(options.store.value_or(usual_store(options)), options);
    options.watch = &keeping;
  }
  const Start start = start_of(scene, q0, qd0, t0, t_end, warn);
  py::object event_functions;
  if (!options.events.empty()) {
    event_functions = functions_of(given["events"]);
  }
  const auto without_lock = [&] {
    const py::gil_scoped_release released;
    return simulate(scene, start.q0, start.qd0, start.t0, start.t_end, std::move(options));
  };
  std::unique_ptr<Run> run(new Run{.scene = python_scene,
                                   .solution = without_lock(),
                                   .event_functions = std::move(event_functions)});
  monitor.close(*run);
  return run;
}

}  // namespace

void bind_simulate(py::module_& module) {
  module.def("simulate", &simulate_run, py::arg("scene"), py::arg("q0"), py::arg("qd0"),
             py::arg("t0"), py::arg("t_end"), py::arg("options"), py::arg("progress"),
             py::arg("warn"), py::arg("watch") = py::none());
}

}  // namespace pendcore::bindings
