#include <pybind11/stl.h>

#include "arguments.hpp"
#include "bind_options.hpp"
#include "ensemble/lanes.hpp"
#include "kind_and_values.hpp"
#include "pendcore/ensemble.hpp"
#include "pendcore/parameters.hpp"
#include "python_monitor.hpp"
#include "scene/degrees.hpp"

namespace pendcore::bindings {
namespace {

/// An array whose leading axes count the members; the last one holds the numbers of a member. An
/// axis that was broadcast has stride 0, and takes no memory.
class RowsOfMembers {
 public:
  /// `shape` is that of the ensemble.
  RowsOfMembers(const char* name, const py::array_t<double>& array,
                const std::vector<py::ssize_t>& shape, std::size_t size)
      : array_(array), shape_(shape), size_(size) {
    bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size()) + 1 &&
                array.shape(array.ndim() - 1) == static_cast<py::ssize_t>(size);
    for (std::size_t axis = 0; fits && axis < shape.size(); ++axis) {
      fits = array.shape(static_cast<py::ssize_t>(axis)) == shape[axis];
    }
    if (!fits) throw py::value_error(std::string(name) + ": must have the shape of the ensemble");
    data_ = reinterpret_cast<const char*>(array.data());
    strides_.assign(array.strides(), array.strides() + array.ndim());
  }

  void copy(std::size_t member, double* to) const {
    const char* from = data_;
    auto left = static_cast<py::ssize_t>(member);
    for (std::size_t axis = shape_.size(); axis-- > 0;) {
      from += left % shape_[axis] * strides_[axis];
      left /= shape_[axis];
    }
    for (std::size_t k = 0; k < size_; ++k, from += strides_.back()) {
      __builtin_memcpy(to + k, from, sizeof(double));
    }
  }

 private:
  py::array_t<double> array_;
  std::vector<py::ssize_t> shape_;
  std::size_t size_;
  const char* data_;
  std::vector<py::ssize_t> strides_;
};

template <class Number>
std::span<Number> all_of(py::array_t<Number, py::array::c_style>& array) {
  return {array.mutable_data(), static_cast<std::size_t>(array.size())};
}

/// What a reducer finds, if it is wanted.
using Kept = std::optional<py::array_t<double, py::array::c_style>>;
std::span<double> all_of(Kept& kept) { return kept ? all_of(*kept) : std::span<double>(); }

/// Runs the members, and writes what is kept of them into the arrays from `status` on. Returns
/// (status, statistics, exception or None) of the whole.
py::tuple ensemble(const Scene& scene, const std::vector<py::ssize_t>& shape,
                   const py::array_t<double>& q0, const py::array_t<double>& qd0,
                   const std::vector<std::string>& names,
                   const std::vector<py::array_t<double>>& values, py::handle t0, py::handle t_end,
                   const py::dict& given, int workers, double time_limit, py::handle progress,
                   const std::vector<std::string>& sensitivity_names,
                   py::array_t<std::uint8_t, py::array::c_style> status,
                   py::array_t<double, py::array::c_style> t,
                   py::array_t<double, py::array::c_style> states, Kept first_found, Kept extremes,
                   Kept energy_drift, Kept largest_exponent, Kept sensitivities) {
  const std::size_t n = scene.links.size();
  PythonMonitor monitor(progress);
  const Options options = options_of(given, n);
  const RowsOfMembers angles("q0", q0, shape, n);
  const RowsOfMembers rates("qd0", qd0, shape, n);
  std::vector<RowsOfMembers> parameters;
  for (const py::array_t<double>& one : values) parameters.emplace_back("vary", one, shape, 1);
  const Members members{.count = static_cast<std::size_t>(status.size()),
                        .names = names,
                        .read = [&](std::size_t i, double* q, double* qd, double* vary) {
                          angles.copy(i, q);
                          rates.copy(i, qd);
                          for (const RowsOfMembers& one : parameters) one.copy(i, vary++);
                        }};
  const double begin = number("t_span[0]", t0);
  const double end = number("t_span[1]", t_end);
  const EnsembleLimits limits{
      .workers = workers, .time_limit = time_limit, .monitor = monitor.for_core()};
  const MemberResults results{.status = all_of(status),
                              .t = all_of(t),
                              .states = all_of(states),
                              .first_found = all_of(first_found),
                              .extremes = all_of(extremes),
                              .energy_drift = all_of(energy_drift),
                              .largest_exponent = all_of(largest_exponent),
                              .sensitivities = all_of(sensitivities),
                              .sensitivity_names = sensitivity_names};
  EnsembleEnding ending;
  {
    const py::gil_scoped_release without_lock;
    ending = run_ensemble(scene, members, begin, end, options, limits, results);
  }
  std::string message(text(ending.status).sentence);
  std::exception_ptr none;
  const py::object error = monitor.close(ending.status, message, none);
  return py::make_tuple(text(ending.status).name, statistics(ending.statistics), error);
}

py::list named_numbers(const Scene& scene) {
  py::list result;
  for (const NamedNumber& one : parameters(scene)) {
    result.append(py::make_tuple(one.name, one.unit, one.value));
  }
  return result;
}

}  // namespace

void bind_ensemble(py::module_& module) {
  module.def("ensemble", &ensemble, py::arg("scene"), py::arg("shape"), py::arg("q0"),
             py::arg("qd0"), py::arg("names"), py::arg("values"), py::arg("t0"), py::arg("t_end"),
             py::arg("options"), py::arg("workers"), py::arg("time_limit"), py::arg("progress"),
             py::arg("sensitivity_names"), py::arg("status"), py::arg("t"), py::arg("states"),
             py::arg("first_found"), py::arg("extremes"), py::arg("energy_drift"),
             py::arg("largest_exponent"), py::arg("sensitivities"));
  module.def(
      "methods_with_lanes",
      [](const Scene& scene) { return py::tuple(py::cast(methods_with_lanes(scene))); },
      py::arg("scene"));
  module.def("parameters", &named_numbers, py::arg("scene"));
  module.def(
      "first_in_degrees",
      [](const py::array_t<double, py::array::c_style>& angles) {
        return first_in_degrees({angles.data(), static_cast<std::size_t>(angles.size())});
      },
      py::arg("angles"));
  module.def("warning_of_degrees", &warning_of_degrees, py::arg("name"), py::arg("angle"));
  module.def("check_parameter_names",
             [](const Scene& scene, const std::vector<std::string>& names) {
               static_cast<void>(ParameterChoice(scene, names));
             });
  const std::vector<std::string_view> names = member_status_names();
  std::vector<bool> successes;
  for (std::size_t i = 0; i < names.size(); ++i) {
    successes.push_back(is_success(static_cast<std::uint8_t>(i)));
  }
  module.attr("member_statuses") = py::tuple(py::cast(names));
  module.attr("member_successes") = py::tuple(py::cast(successes));
}

}  // namespace pendcore::bindings
