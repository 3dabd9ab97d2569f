#include <pybind11/stl.h>

#include "arguments.hpp"
#include "integrate/method_list.hpp"
#include "pendcore/methods.hpp"

namespace pendcore::bindings {
namespace {

template <class Row>
py::list fractions(const Row& row) {
  py::list numbers;
  for (const Fraction& f : row) {
    numbers.append(py::make_tuple(f.numerator, f.denominator, f.root));
  }
  return numbers;
}

template <class Table>
py::list rows_of_fractions(const Table& table) {
  py::list rows;
  for (const auto& row : table) rows.append(fractions(row));
  return rows;
}

template <const auto& first, const auto& second>
py::dict tableau(const StiffSwitching<first, second>& /*method*/) {
  return {};
}
py::dict tableau(const TaylorSeries& /*method*/) { return {}; }

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
  result["d"] = fractions(method.d);
  result["functions"] = rows_of_fractions(method.interpolant);
  py::list basis;
  for (const auto& row : method.basis) {
    py::list powers;
    for (const int weight : row) powers.append(py::make_tuple(weight, 1, 0));
    basis.append(powers);
  }
  result["basis"] = basis;
  return result;
}

py::dict tableau_of(const std::string& method) {
  py::dict result;
  Methods::with(find_method(method).name, [&]<const auto & table>() { result = tableau(table); });
  return result;
}

py::dict describe(const MethodInfo& info) {
  py::dict result;
  result["name"] = info.name;
  result["aliases"] = std::vector(info.aliases.begin(), info.aliases.end());
  constexpr std::string_view kinds[] = {"explicit", "implicit", "taylor", "pair"};
  result["kind"] = kinds[static_cast<std::size_t>(info.kind)];
  result["first"] = info.first();
  result["second"] = info.second_of_pair;
  result["dense_output_is_series"] = info.dense_output_is_series;
  result["order"] = info.order;
  result["error_order"] = info.error_order;
  result["interpolant_order"] = info.interpolant_order;
  result["beta"] = info.beta;
  result["compensates"] = info.compensates;
  result["sentence"] = info.sentence;
  result["citation"] = info.citation;
  result["error_over_rtol"] = info.error_over_rtol;
  result["second_opinion"] = info.second_opinion;
  result["line"] = py::make_tuple(info.line.color, info.line.dash, info.line.marker);
  return result;
}

}  // namespace

void bind_methods(py::module_& module) {
  module.def(
      "methods",
      [] {
        py::list result;
        for (const MethodInfo* info : methods()) result.append(describe(*info));
        return result;
      },
      "A dictionary for each method, with what is known of it.");
  module.def(
      "tableau", &tableau_of, py::arg("method"),
      "The coefficients c, a, b, e, d of a method, the functions of its dense output (function,\n"
      "stage) and the basis of these (function, power). Each number is a triple (numerator,\n"
      "denominator, root of 6): (numerator + root sqrt(6)) / denominator. An implicit method has\n"
      "plain numbers; pairs and series have nothing.");
  module.def(
      "nearest_double",
      [](long long numerator, long long denominator, long long root) {
        return Fraction{numerator, denominator, root}.value;
      },
      py::arg("numerator"), py::arg("denominator"), py::arg("root"),
      "The double that the core takes for (numerator + root sqrt(6)) / denominator.");
}

}  // namespace pendcore::bindings
