#include <pybind11/stl.h>

#include "arguments.hpp"
#include "pendcore/integrate/methods.hpp"

namespace pendcore::bindings {
namespace {

template <class Row>
py::list fractions(const Row& row) {
  py::list pairs;
  for (const Fraction& f : row) pairs.append(py::make_tuple(f.numerator, f.denominator));
  return pairs;
}

template <class Table>
py::list rows_of_fractions(const Table& table) {
  py::list rows;
  for (const auto& row : table) rows.append(fractions(row));
  return rows;
}

py::dict tableau(const Automatic& /*method*/) { return {}; }

py::dict tableau(const Collocation& method) {
  py::dict result;
  result["c"] = method.c;
  result["a"] = method.a;
  result["real"] = method.real;
  result["alpha"] = method.alpha;
  result["beta"] = method.beta;
  result["transformation"] = method.transformation;
  result["inverse"] = method.inverse;
  result["interpolant"] = method.interpolant;
  result["correction"] = method.correction;
  return result;
}

template <class Method>
py::dict tableau(const Method& method) {
  py::dict result;
  result["c"] = fractions(method.c);
  result["a"] = rows_of_fractions(method.a);
  result["b"] = fractions(method.b);
  result["e"] = fractions(method.e);
  result["interpolant"] = rows_of_fractions(method.interpolant);
  return result;
}

template <const auto&... tables>
py::dict tableau_named(MethodList<tables...>, std::string_view name) {
  py::dict result;
  ((tables.info.name == name ? void(result = tableau(tables)) : void()), ...);
  return result;
}

py::dict describe(const MethodInfo& info) {
  py::list aliases;
  for (std::string_view alias : info.aliases) aliases.append(string(alias));
  py::dict result;
  result["name"] = string(info.name);
  result["aliases"] = aliases;
  constexpr std::string_view kinds[] = {"explicit", "implicit", "automatic"};
  result["kind"] = string(kinds[static_cast<std::size_t>(info.kind)]);
  result["order"] = info.order;
  result["error_order"] = info.error_order;
  result["interpolant_order"] = info.interpolant_order;
  result["beta"] = info.beta;
  result["compensates"] = info.compensates;
  result["citation"] = string(info.citation);
  return result;
}

}  // namespace

void bind_methods(py::module_& module) {
  module.def(
      "methods",
      [] {
        py::list result;
        for (const MethodInfo* info : Methods::infos) result.append(describe(*info));
        return result;
      },
      "What is known of each method, a dictionary each.");
  module.def(
      "tableau",
      [](const std::string& method) { return tableau_named(Methods{}, find_method(method).name); },
      py::arg("method"),
      "The coefficients c, a, b, e (b minus the embedded method's) and interpolant (stage, power)\n"
      "of a method, each a pair (numerator, denominator); of an implicit method, numbers;\n"
      "of auto, none.");
}

}  // namespace pendcore::bindings
