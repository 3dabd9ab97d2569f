#include "pendcore/lyapunov.hpp"
#include "python_monitor.hpp"
#include "start.hpp"

namespace pendcore::bindings {
namespace {

py::dict exponents(const Scene& scene, py::handle q0, py::handle qd0, py::handle t0,
                   py::handle t_end, py::handle count, py::handle rtol, py::handle atol,
                   py::handle since, py::handle t_eval, py::handle max_step, py::handle max_steps,
                   py::handle time_limit, py::handle progress, py::handle warn) {
  PythonMonitor monitor(progress);
  LyapunovOptions options;
  take("count", count, options.count);
  take("rtol", rtol, options.rtol);
  take("atol", atol, options.atol);
  take("since", since, options.since);
  take("t_eval", t_eval, options.t_eval);
  take("max_step", max_step, options.max_step);
  take("max_steps", max_steps, options.max_steps);
  if (!time_limit.is_none()) take("time_limit", time_limit, options.time_limit);
  options.monitor = monitor.for_core();
  const Start start = start_of(scene, q0, qd0, t0, t_end, warn);
  TangentGrowth found;
  {
    const py::gil_scoped_release without_lock;
    found = lyapunov(scene, start.q0, start.qd0, start.t0, start.t_end, options);
  }
  const py::object error = monitor.close(found.status, found.message, found.error);
  py::dict result;
  result["t"] = copy(found.t);
  result["growth"] = copy(found.growth, shape(found.t.size(), found.count));
  result["states"] = copy(found.states, shape(found.t.size(), 2 * scene.links.size()));
  result["t_reached"] = found.t_reached;
  result["status"] = text(found.status).name;
  result["message"] = found.message;
  result["statistics"] = statistics(found.statistics);
  result["error"] = error;
  return result;
}

}  // namespace

void bind_lyapunov(py::module_& module) {
  module.def("lyapunov", &exponents, py::arg("scene"), py::arg("q0"), py::arg("qd0"), py::arg("t0"),
             py::arg("t_end"), py::arg("count"), py::arg("rtol"), py::arg("atol"), py::arg("since"),
             py::arg("t_eval"), py::arg("max_step"), py::arg("max_steps"), py::arg("time_limit"),
             py::arg("progress"), py::arg("warn"));
}

}  // namespace pendcore::bindings
