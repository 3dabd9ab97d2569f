#include <tuple>
#include <vector>

#include "analysis/defect_correction.hpp"
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

void bind_defect_correction(py::module_& module) {
  py::class_<DefectCorrection>(module, "DefectCorrection")
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
