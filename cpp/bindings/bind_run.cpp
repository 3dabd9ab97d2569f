#include <pybind11/stl.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <utility>

#include "analysis/defect.hpp"
#include "arguments.hpp"
#include "bind_options.hpp"
#include "kind_and_values.hpp"
#include "pendcore/simulate.hpp"
#include "pendcore/solution.hpp"
#include "python_monitor.hpp"

namespace pendcore::bindings {
namespace {

/// Every event that was asked for, as (kind, values).
py::tuple event_pairs(const Run& run) {
  py::list pairs;
  for (std::size_t i = 0; i < run.solution.options.events.size(); ++i) {
    const py::object f =
        run.event_functions ? py::object(run.event_functions[py::int_(i)]) : py::none();
    pairs.append(kind_and_values(run.solution.options.events[i], f));
  }
  return py::tuple(pairs);
}

/// Every event that was found: (number from 0, t, direction, y, y_before or None).
py::list found(const Run& run) {
  py::list result;
  for (const FoundEvent& one : run.solution.found) {
    const py::object before =
        one.y_before.empty() ? py::object(py::none()) : py::object(copy(one.y_before));
    result.append(py::make_tuple(one.event, one.t, one.direction, copy(one.y), before));
  }
  return result;
}

/// The keywords of simulate() as they were given.
py::dict arguments(const Run& run) {
  const Solution& s = run.solution;
  const std::ptrdiff_t n = s.n;
  py::dict result = as_python(s.options);
  result["q0"] = copy(std::span(s.start).first(n));
  result["qd0"] = copy(std::span(s.start).subspan(n, n));
  result["t_start"] = s.t0;
  result["t_end"] = s.t_end;
  result["events"] = event_pairs(run);
  return result;
}

Run resume_run(const Run& run, py::handle t_end, py::handle t_eval, py::handle max_steps,
               py::handle time_limit, py::handle progress) {
  PythonMonitor monitor(progress);
  const double end = number("t_end", t_end);
  const std::vector<double> times =
      t_eval.is_none() ? std::vector<double>{} : numbers("t_eval", t_eval);
  const long long most = whole_number("max_steps", max_steps);
  std::optional<double> limit;
  take("time_limit", time_limit, limit);
  const Scene& scene = scene_of(run);
  const auto without_lock = [&] {
    const py::gil_scoped_release released;
    return resume(scene, run.solution, end, times, most, limit, monitor.for_core());
  };
  Run longer{
      .scene = run.scene, .solution = without_lock(), .event_functions = run.event_functions};
  monitor.close(longer);
  return longer;
}

/// The exception that broke the run off, or None. It belongs to whoever raises it: it will hold the
/// solution, and if the run held it as well, neither would ever be freed.
py::object take_error(Run& run) { return std::exchange(run.error, py::none()); }

/// Shows Python's collector what a run holds: a function among its events may know the solution.
/// There is no tp_clear, because every cycle through a run has Python's own objects to break it at,
/// and a run without its functions could not go on.
void collect_cycles(PyHeapTypeObject* heap_type) {
  PyTypeObject& type = heap_type->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) -> int {
    Py_VISIT(Py_TYPE(self));
    if (!py::detail::is_holder_constructed(self)) return 0;
    const Run& run = py::cast<const Run&>(py::handle(self));
    Py_VISIT(run.scene.ptr());
    Py_VISIT(run.event_functions.ptr());
    Py_VISIT(run.error.ptr());
    return 0;
  };
}

/// Some columns of the rows that a solution keeps: angles, rates, then the ledger's entries.
py::array columns(const py::array& rows, int begin, int end) {
  return rows[py::make_tuple(py::slice(0, rows.shape(0), 1), py::slice(begin, end, 1))];
}

py::array rows(const py::object& self) {
  const Solution& s = self.cast<const Run&>().solution;
  return view(s.states, shape(s.t.size(), s.dimension), self);
}

/// The entries of the ledger in rows of a solution's dimension.
py::dict entries(const Solution& s, const py::array& rows) {
  py::dict result;
  int column = 2 * s.n;
  for (const Account account : s.accounts) {
    const py::array entry = columns(rows, column, column + 1);
    result[py::str(account_name(account))] = entry.attr("reshape")(-1);
    ++column;
  }
  return result;
}

py::dict ledger(const py::object& self) {
  return entries(self.cast<const Run&>().solution, rows(self));
}

py::array rows_at(const Solution& s, const Array& t) {
  const Matrix rows = s.sample(View(t.data(), t.size()));
  return Array({t.size(), py::ssize_t{s.dimension}}, rows.data());
}

py::array evaluate(const Run& run, const Array& t) {
  return columns(rows_at(run.solution, t), 0, 2 * run.solution.n);
}

py::dict ledger_at(const Run& run, const Array& t) {
  return entries(run.solution, rows_at(run.solution, t));
}

/// The defect of steps first .. end - 1: (torques, distances of the angles, the curve's angles at
/// the end).
py::tuple defect_of_steps(const Run& run, std::size_t first, std::size_t end, const Array& angles) {
  const Solution& s = run.solution;
  std::vector<double> q(angles.data(), angles.data() + angles.size());
  if (end > s.dense.h.size() || first > end || !(q.empty() || q.size() == std::size_t(s.n))) {
    throw py::value_error("defect: there are no such steps, or no such angles");
  }
  const Defect found = defect(scene_of(run), s, first, end, q);
  return py::make_tuple(copy(found.torque, shape(end - first, s.n)), copy(found.apart), copy(q));
}

}  // namespace

void bind_run(py::module_& module) {
  const auto of_solution = [](auto Solution::* field) {
    return [field](const Run& run) { return run.solution.*field; };
  };
  py::class_<Run>(module, "Run", py::custom_type_setup(&collect_cycles),
                  "The result of a simulation, as the core holds it.")
      .def_property_readonly("t",
                             [](py::object self) {
                               const Solution& s = self.cast<const Run&>().solution;
                               return view(s.t, shape(s.t.size()), self);
                             })
      .def_property_readonly("states",
                             [](const py::object& self) {
                               const Solution& s = self.cast<const Run&>().solution;
                               const py::array all = rows(self);
                               return s.dimension == 2 * s.n ? all : columns(all, 0, 2 * s.n);
                             })
      .def_property_readonly("ledger", &ledger)
      .def_property_readonly("found", &found)
      .def_property_readonly("t_reached", of_solution(&Solution::t_reached))
      .def_property_readonly("y_reached",
                             [](const Run& run) {
                               const std::vector<double>& y = run.solution.y_reached;
                               return copy(std::span(y).first(2 * run.solution.n));
                             })
      .def_property_readonly("status",
                             [](const Run& run) { return text(run.solution.status).name; })
      .def_property_readonly("message", of_solution(&Solution::message))
      .def_property_readonly("success",
                             [](const Run& run) { return text(run.solution.status).success; })
      .def_property_readonly("method", [](const Run& run) { return run.solution.options.method; })
      .def_property_readonly("last_method", of_solution(&Solution::last_method))
      .def_property_readonly(
          "store", [](const Run& run) { return store_name(run.solution.options.store.value()); })
      .def_property_readonly("statistics",
                             [](const Run& run) { return statistics(run.solution.statistics); })
      .def_property_readonly("arguments", &arguments)
      .def_property_readonly("fingerprint",
                             [](const Run& run) {
                               char digits[17];
                               std::snprintf(digits, sizeof digits, "%016" PRIx64,
                                             fingerprint(run.solution));
                               return std::string(digits);
                             })
      .def("take_error", &take_error)
      .def("evaluate", &evaluate, py::arg("t"))
      .def("ledger_at", &ledger_at, py::arg("t"))
      .def_property_readonly("step_starts",
                             [](py::object self) {
                               const Solution& s = self.cast<const Run&>().solution;
                               return view(s.dense.start, shape(s.dense.start.size()), self);
                             })
      .def_property_readonly("dense_degree",
                             [](const Run& run) { return run.solution.dense.degree; })
      .def("defect", &defect_of_steps, py::arg("first"), py::arg("end"), py::arg("angles"))
      .def("resume", &resume_run, py::arg("t_end"), py::arg("t_eval"), py::arg("max_steps"),
           py::arg("time_limit"), py::arg("progress"))
      .def(py::pickle(&get_state, &set_state));
}

}  // namespace pendcore::bindings
