#include "run.hpp"

namespace pendcore::bindings {
namespace {

Store store_named(py::handle store, bool has_times) {
  if (store.is_none()) return has_times ? Store::times : Store::dense;
  const std::string name = py::str(store);
  if (name == "end") return Store::end;
  if (name == "times") return Store::times;
  if (name == "steps") return Store::steps;
  if (name == "dense") return Store::dense;
  throw py::value_error("store = " + py::repr(store).cast<std::string>() +
                        ": must be \"dense\", \"steps\", \"times\" or \"end\"");
}

Run simulate_run(const Scene& scene, py::handle q0, py::handle qd0, py::handle t0, py::handle t_end,
                 py::handle method, py::handle rtol, py::handle atol, py::handle t_eval,
                 py::handle store, py::handle first_step, py::handle max_step, py::handle step,
                 py::handle max_steps, py::handle time_limit, py::handle progress) {
  if (!py::isinstance<py::str>(method)) {
    throw py::type_error("method = " + py::repr(method).cast<std::string>() +
                         ": must be the name of a method");
  }
  const std::size_t n = scene.links.size();
  const std::string one_a_link = "(" + std::to_string(n) + ",)";
  const std::string one_a_component = "a number or (" + std::to_string(2 * n) + ",)";
  PythonMonitor monitor(progress);
  Options options;
  options.method = method.cast<std::string>();
  options.rtol = numbers("rtol", rtol, one_a_component);
  options.atol = numbers("atol", atol, one_a_component);
  if (!t_eval.is_none()) options.t_eval = numbers("t_eval", t_eval);
  options.store = store_named(store, !t_eval.is_none());
  if (options.store == Store::times && t_eval.is_none()) {
    throw py::value_error("t_eval: store=\"times\" keeps the times in t_eval: give them (s)");
  }
  if ((options.store == Store::end || options.store == Store::steps) && !t_eval.is_none()) {
    throw py::value_error(
        "store: keeps no times of t_eval: must be \"times\" or \"dense\" with it");
  }
  options.first_step = optional_number("first_step", first_step);
  options.max_step = number("max_step", max_step);
  options.step = optional_number("step", step);
  options.max_steps = whole_number("max_steps", max_steps);
  options.time_limit = optional_number("time_limit", time_limit).value_or(options.time_limit);
  options.monitor = monitor;
  const std::vector<double> angles = numbers("q0", q0, one_a_link, n);
  const std::vector<double> rates = numbers("qd0", qd0, one_a_link, n);
  const double from = number("t_span[0]", t0);
  const double to = number("t_span[1]", t_end);

  Run run{.scene = scene, .solution = {}};
  {
    const py::gil_scoped_release without_lock;
    run.solution = simulate(run.scene, angles, rates, from, to, options);
  }
  monitor.close(run);
  return run;
}

}  // namespace

bool PythonMonitor::operator()(double fraction) {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() == 0) {
    if (progress_.is_none()) return true;
    const py::object done = py::float_(fraction);
    PyObject* result = PyObject_CallOneArg(progress_.ptr(), done.ptr());
    Py_XDECREF(result);
    if (result != nullptr) return true;
  }
  py::error_already_set error;
  *error_ = error.value();
  return false;
}

void PythonMonitor::close(Run& run) const {
  if (!*error_) return;
  run.error = *error_;
  if (!PyErr_GivenExceptionMatches(run.error.ptr(), PyExc_KeyboardInterrupt)) {
    run.solution.status = Status::callback_error;
    run.solution.message = text(Status::callback_error).sentence;
  }
}

void bind_simulate(py::module_& module) {
  module.def("simulate", &simulate_run, py::arg("scene"), py::arg("q0"), py::arg("qd0"),
             py::arg("t0"), py::arg("t_end"), py::arg("method"), py::arg("rtol"), py::arg("atol"),
             py::arg("t_eval"), py::arg("store"), py::arg("first_step"), py::arg("max_step"),
             py::arg("step"), py::arg("max_steps"), py::arg("time_limit"), py::arg("progress"));
}

}  // namespace pendcore::bindings
