#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <utility>

#include "pendcore/integrate/methods.hpp"
#include "run.hpp"

namespace pendcore::bindings {
namespace {

constexpr std::array<const char*, 4> store_names = {"end", "times", "steps", "dense"};

py::dict to_dict(const Statistics& s) {
  py::dict result;
  result["nfev"] = s.nfev;
  result["njev"] = s.njev;
  result["nlu"] = s.nlu;
  result["accepted"] = s.accepted;
  result["rejected"] = s.rejected;
  result["limited_by_tolerance"] = s.limited_by_tolerance;
  result["limited_by_max_step"] = s.limited_by_max_step;
  result["limited_by_break"] = s.limited_by_break;
  result["min_step"] = s.min_step;
  result["max_step"] = s.max_step;
  result["stiff"] = s.stiff;
  return result;
}

Statistics to_statistics(const py::dict& d) {
  return {.nfev = d["nfev"].cast<long long>(),
          .njev = d["njev"].cast<long long>(),
          .nlu = d["nlu"].cast<long long>(),
          .accepted = d["accepted"].cast<long long>(),
          .rejected = d["rejected"].cast<long long>(),
          .limited_by_tolerance = d["limited_by_tolerance"].cast<long long>(),
          .limited_by_max_step = d["limited_by_max_step"].cast<long long>(),
          .limited_by_break = d["limited_by_break"].cast<long long>(),
          .min_step = d["min_step"].cast<double>(),
          .max_step = d["max_step"].cast<double>(),
          .stiff = d["stiff"].cast<bool>()};
}

py::ssize_t size(const std::vector<double>& numbers) {
  return static_cast<py::ssize_t>(numbers.size());
}

py::array copy_flat(const std::vector<double>& numbers) { return copy(numbers, {size(numbers)}); }

py::object one_or_many(const std::vector<double>& numbers) {
  if (numbers.size() == 1) return py::float_(numbers[0]);
  return copy_flat(numbers);
}

template <class Number>
py::object or_none(bool given, Number value) {
  return given ? py::cast(value) : py::none();
}

/// The keywords of simulate() as they were given.
py::dict arguments(const Run& run) {
  const Solution& s = run.solution;
  const auto n = static_cast<std::ptrdiff_t>(run.scene.links.size());
  const bool times = !s.options.t_eval.empty();
  py::dict result;
  result["q0"] = copy_flat({s.start.begin(), s.start.begin() + n});
  result["qd0"] = copy_flat({s.start.begin() + n, s.start.end()});
  result["t_start"] = s.t0;
  result["t_end"] = s.t_end;
  result["method"] = s.options.method;
  result["rtol"] = one_or_many(s.options.rtol);
  result["atol"] = one_or_many(s.options.atol);
  result["t_eval"] = times ? py::object(copy_flat(s.options.t_eval)) : py::none();
  const Store usual = times ? Store::times : Store::dense;
  result["store"] =
      or_none(s.options.store != usual, store_names[static_cast<int>(s.options.store)]);
  result["first_step"] = s.options.first_step;
  result["max_step"] = s.options.max_step;
  result["step"] = s.options.step;
  result["max_steps"] = s.options.max_steps;
  result["time_limit"] = or_none(std::isfinite(s.options.time_limit), s.options.time_limit);
  return result;
}

/// Everything as numbers, strings and arrays of numbers, so that it fits a pickle and an npz alike.
/// A number that was not given is a NaN.
py::dict get_state(const Run& run) {
  const Solution& s = run.solution;
  const Position& p = s.resumable;
  std::vector<double> links;
  for (const Link& link : run.scene.links) {
    links.insert(links.end(), {link.mass, link.length, link.center, link.inertia});
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  py::dict d;
  d["links"] = copy(links, {size(links) / 4, 4});
  d["gravity"] = run.scene.gravity;
  d["status"] = text(s.status).name;
  d["message"] = s.message;
  d["t"] = copy_flat(s.t);
  d["states"] = copy_flat(s.states);
  d["dense_degree"] = s.dense.degree;
  d["dense_start"] = copy_flat(s.dense.start);
  d["dense_h"] = copy_flat(s.dense.h);
  d["dense_coefficients"] = copy_flat(s.dense.coefficients);
  d["method"] = s.options.method;
  d["rtol"] = copy_flat(s.options.rtol);
  d["atol"] = copy_flat(s.options.atol);
  d["store"] = store_names[static_cast<int>(s.options.store)];
  d["t_eval"] = copy_flat(s.options.t_eval);
  d["first_step"] = s.options.first_step.value_or(none);
  d["max_step"] = s.options.max_step;
  d["step"] = s.options.step.value_or(none);
  d["max_steps"] = s.options.max_steps;
  d["time_limit"] = s.options.time_limit;
  d["t_start"] = s.t0;
  d["t_end"] = s.t_end;
  d["start"] = copy_flat(s.start);
  d["t_reached"] = s.t_reached;
  d["y_reached"] = copy_flat(s.y_reached);
  d["resumable_t"] = s.resumable_t;
  d["resumable_steps"] = s.resumable_steps;
  d["position_t"] = copy_flat({p.t.high, p.t.low});
  d["position_h"] = p.h;
  d["position_h_is_max_step"] = p.h_is_max_step;
  d["position_log2_error_before"] = p.control.log2_error_before;
  d["position_after_rejection"] = p.control.after_rejection;
  d["position_stiff_hits"] = p.stiff_hits;
  d["position_stiff_misses"] = p.stiff_misses;
  d["position_y"] = copy_flat(p.y);
  d["position_dydt"] = copy_flat(p.dydt);
  for (const auto& [prefix, statistics] :
       {std::pair{"statistics_", s.statistics}, std::pair{"position_statistics_", p.statistics}}) {
    for (const auto& [key, value] : to_dict(statistics)) {
      d[py::str(prefix + key.cast<std::string>())] = value;
    }
  }
  return d;
}

Statistics statistics_from(const py::dict& state, const std::string& prefix) {
  py::dict d;
  for (const auto& [key, value] : to_dict({})) {
    d[key] = state[py::str(prefix + key.cast<std::string>())];
  }
  return to_statistics(d);
}

std::optional<double> optional_from(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

template <class Names>
int index_of(const Names& names, const std::string& name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<int>(i);
  }
  throw py::value_error("unknown name \"" + name + "\"");
}

void check_sizes(const Solution& s);

Run set_state(const py::dict& d) {
  auto vector = [&](const char* key) { return numbers(key, d[key]); };
  auto real = [&](const char* key) { return number(key, d[key]); };
  auto count = [&](const char* key) { return d[key].cast<long long>(); };
  Run run;
  const std::vector<double> links = numbers("links", d["links"].attr("ravel")());
  for (std::size_t i = 0; i + 4 <= links.size(); i += 4) {
    run.scene.links.push_back({links[i], links[i + 1], links[i + 2], links[i + 3]});
  }
  run.scene.gravity = real("gravity");
  check(run.scene);
  Solution& s = run.solution;
  std::array<std::string_view, status_texts.size()> status_names;
  for (std::size_t i = 0; i < status_names.size(); ++i) status_names[i] = status_texts[i].name;
  s.status = static_cast<Status>(index_of(status_names, d["status"].cast<std::string>()));
  s.message = d["message"].cast<std::string>();
  s.statistics = statistics_from(d, "statistics_");
  s.t = vector("t");
  s.states = vector("states");
  s.dense = {.degree = static_cast<int>(count("dense_degree")),
             .start = vector("dense_start"),
             .h = vector("dense_h"),
             .coefficients = vector("dense_coefficients")};
  s.options.method = find_method(d["method"].cast<std::string>()).name;
  s.options.rtol = vector("rtol");
  s.options.atol = vector("atol");
  s.options.store = static_cast<Store>(index_of(store_names, d["store"].cast<std::string>()));
  s.options.t_eval = vector("t_eval");
  s.options.first_step = optional_from(real("first_step"));
  s.options.max_step = real("max_step");
  s.options.step = optional_from(real("step"));
  s.options.max_steps = count("max_steps");
  s.options.time_limit = real("time_limit");
  s.t0 = real("t_start");
  s.t_end = real("t_end");
  s.start = vector("start");
  s.dimension = 2 * static_cast<int>(run.scene.links.size());
  s.t_reached = real("t_reached");
  s.y_reached = vector("y_reached");
  s.resumable_t = static_cast<std::size_t>(count("resumable_t"));
  s.resumable_steps = static_cast<std::size_t>(count("resumable_steps"));
  Position& p = s.resumable;
  const std::vector<double> t = vector("position_t");
  if (t.size() != 2) throw py::value_error("position_t: must have two numbers");
  p.t = {t[0], t[1]};
  p.h = real("position_h");
  p.h_is_max_step = d["position_h_is_max_step"].cast<bool>();
  p.control = {.log2_error_before = real("position_log2_error_before"),
               .after_rejection = d["position_after_rejection"].cast<bool>()};
  p.stiff_hits = static_cast<int>(count("position_stiff_hits"));
  p.stiff_misses = static_cast<int>(count("position_stiff_misses"));
  p.y = vector("position_y");
  p.dydt = vector("position_dydt");
  p.statistics = statistics_from(d, "position_statistics_");
  check_sizes(s);
  return run;
}

/// A damaged file must end in an error, never in memory that is not ours.
void check_sizes(const Solution& s) {
  const auto n = static_cast<std::size_t>(s.dimension);
  const std::size_t steps = s.dense.h.size();
  const bool fits =
      s.states.size() == s.t.size() * n && s.start.size() == n && s.y_reached.size() == n &&
      s.resumable.y.size() == n && s.resumable.dydt.size() == n && s.resumable_t <= s.t.size() &&
      s.resumable_steps <= steps && s.dense.start.size() == steps && s.dense.degree >= 0 &&
      s.dense.degree <= 64 &&
      s.dense.coefficients.size() == steps * (static_cast<std::size_t>(s.dense.degree) + 1) * n;
  if (!fits) throw py::value_error("the arrays of this solution do not fit together");
}

Run resume_run(const Run& run, py::handle t_end, py::handle t_eval, py::handle max_steps,
               py::handle time_limit, py::handle progress) {
  PythonMonitor monitor(progress);
  const double end = number("t_end", t_end);
  const std::vector<double> times =
      t_eval.is_none() ? std::vector<double>{} : numbers("t_eval", t_eval);
  const long long most = whole_number("max_steps", max_steps);
  const double limit =
      optional_number("time_limit", time_limit).value_or(std::numeric_limits<double>::infinity());
  Run longer{.scene = run.scene, .solution = {}};
  {
    const py::gil_scoped_release without_lock;
    longer.solution = resume(run.scene, run.solution, end, times, most, limit, monitor);
  }
  monitor.close(longer);
  return longer;
}

py::array evaluate(const Run& run, const Array& t) {
  const std::vector<double> states = run.solution.at({t.data(), t.data() + t.size()});
  return copy(states, {t.size(), run.solution.dimension});
}

}  // namespace

void bind_run(py::module_& module) {
  py::class_<Run>(module, "Run", "The result of a simulation, as the core holds it.")
      .def_property_readonly("t",
                             [](py::object self) {
                               const Solution& s = self.cast<const Run&>().solution;
                               return view(s.t, {size(s.t)}, self);
                             })
      .def_property_readonly("states",
                             [](py::object self) {
                               const Solution& s = self.cast<const Run&>().solution;
                               return view(s.states, {size(s.t), s.dimension}, self);
                             })
      .def_property_readonly("status",
                             [](const Run& run) { return text(run.solution.status).name; })
      .def_property_readonly("message", [](const Run& run) { return run.solution.message; })
      .def_property_readonly("success",
                             [](const Run& run) { return text(run.solution.status).success; })
      .def_property_readonly("method", [](const Run& run) { return run.solution.options.method; })
      .def_property_readonly(
          "store",
          [](const Run& run) { return store_names[static_cast<int>(run.solution.options.store)]; })
      .def_property_readonly("statistics",
                             [](const Run& run) { return to_dict(run.solution.statistics); })
      .def_property_readonly("arguments", &arguments)
      .def_readonly("error", &Run::error)
      .def("evaluate", &evaluate, py::arg("t"))
      .def("resume", &resume_run, py::arg("t_end"), py::arg("t_eval"), py::arg("max_steps"),
           py::arg("time_limit"), py::arg("progress"))
      .def(py::pickle(&get_state, &set_state));
}

}  // namespace pendcore::bindings
