#include <pybind11/stl.h>

#include <string>
#include <tuple>
#include <vector>

#include "analysis/defect_correction.hpp"
#include "analysis/sensitivities.hpp"
#include "arguments.hpp"

namespace pendcore::bindings {
namespace {

DefectCorrection with_neighbours(const py::list& neighbours) {
  DefectCorrection correction;
  for (const py::handle one : neighbours) {
    const auto [scene, q0, points] =
        one.cast<std::tuple<py::object, py::object, std::vector<int>>>();
    const auto& neighbour = scene.cast<const Scene&>();
    correction.add(neighbour, numbers("q0", q0, "(n,)", neighbour.links.size()), points);
  }
  return correction;
}

}  // namespace

void bind_watches(py::module_& module) {
  const py::class_<KeepingWatch> watch(module, "Watch");
  py::class_<Sensitivities, KeepingWatch>(module, "Sensitivities")
      .def(py::init<const Scene&, const std::vector<std::string>&>(), py::arg("scene"),
           py::arg("names"))
      .def_property_readonly("refusal", &Sensitivities::refusal)
      .def_property_readonly("values", [](const Sensitivities& found) {
        const std::size_t row = found.states() * found.names();
        const std::size_t times = row == 0 ? 0 : found.values().size() / row;
        return copy(found.values(), shape(times, found.states(), found.names()));
      });
  py::class_<DefectCorrection, KeepingWatch>(module, "DefectCorrection")
      .def(py::init(&with_neighbours), py::arg("neighbours"))
      .def_property_readonly("t", [](const DefectCorrection& one) { return copy(one.t()); })
      .def_property_readonly("errors",
                             [](const DefectCorrection& one) {
                               return copy(one.errors(),
                                           shape(one.t().size(), one.neighbours(), one.links()));
                             })
      .def_property_readonly("errors_at_end",
                             [](const DefectCorrection& one) {
                               return copy(one.errors_at_end(),
                                           shape(one.neighbours(), 1, one.links()));
                             })
      .def_property_readonly("agreement",
                             [](const DefectCorrection& one) {
                               const auto& [between, largest, at_loss, t_known] = one.agreement();
                               return py::make_tuple(between, largest, at_loss, t_known);
                             })
      .def_property_readonly("nfev", &DefectCorrection::nfev);
  module.def("has_defect_correction", &has_defect_correction, py::arg("scene"));
}

}  // namespace pendcore::bindings
