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

py::array errors_of(const DefectCorrection& correction) {
  const auto times = static_cast<py::ssize_t>(correction.t().size());
  const auto neighbours = static_cast<py::ssize_t>(correction.neighbours());
  const auto links = static_cast<py::ssize_t>(correction.links());
  return copy(correction.errors(), {times, neighbours, links});
}

}  // namespace

void bind_watches(py::module_& module) {
  const py::class_<KeepingWatch> watch(module, "Watch");
  py::class_<Sensitivities, KeepingWatch>(module, "Sensitivities")
      .def(py::init<const Scene&, const std::vector<std::string>&>(), py::arg("scene"),
           py::arg("names"))
      .def_property_readonly("refusal", &Sensitivities::refusal)
      .def_property_readonly("values", [](const Sensitivities& found) {
        const auto states = static_cast<py::ssize_t>(found.states());
        const auto names = static_cast<py::ssize_t>(found.names());
        const auto numbers = static_cast<py::ssize_t>(found.values().size());
        const auto times = names == 0 ? 0 : numbers / (states * names);
        return copy(found.values(), {times, states, names});
      });
  py::class_<DefectCorrection, KeepingWatch>(module, "DefectCorrection")
      .def(py::init(&with_neighbours), py::arg("neighbours"))
      .def_property_readonly(
          "t", [](const DefectCorrection& correction) { return copy(correction.t()); })
      .def_property_readonly("errors", &errors_of)
      .def_property_readonly("errors_at_end",
                             [](const DefectCorrection& correction) {
                               const auto links = static_cast<py::ssize_t>(correction.links());
                               const auto neighbours =
                                   static_cast<py::ssize_t>(correction.neighbours());
                               return copy(correction.errors_at_end(), {neighbours, 1, links});
                             })
      .def_property_readonly("agreement",
                             [](const DefectCorrection& correction) {
                               const Agreement& found = correction.agreement();
                               return py::make_tuple(found.between, found.largest, found.at_loss,
                                                     found.t_known);
                             })
      .def_property_readonly("nfev", &DefectCorrection::nfev);
  module.def("has_defect_correction", &has_defect_correction, py::arg("scene"));
}

}  // namespace pendcore::bindings
