#include "described.hpp"
#include "effects/behaviour.hpp"
#include "kind_and_values.hpp"
#include "pendcore/effects.hpp"
#include "python_function.hpp"

namespace pendcore::bindings {
namespace {

/// The name of a parameter's type in Python; a part has its own name.
constexpr std::string_view type_name(const bool& /*x*/) { return "bool"; }
constexpr std::string_view type_name(const int& /*x*/) { return "int"; }
constexpr std::string_view type_name(const double& /*x*/) { return "float"; }
constexpr std::string_view type_name(const std::optional<double>& /*x*/) {
  return "optional float";
}
constexpr std::string_view type_name(const std::array<double, 2>& /*x*/) { return "pair"; }
constexpr std::string_view type_name(const std::vector<double>& /*x*/) { return "floats"; }
constexpr std::string_view type_name(const std::uintptr_t& /*x*/) { return "address"; }
template <OptionalPart Value>
constexpr std::string_view type_name(const Value& /*x*/) {
  return Value::value_type::name;
}

template <class Value>
std::string_view range_text(const ParameterInfo& info) {
  constexpr bool is_number =
      requires(Value value) { value = 0.5; } || requires(Value value) { value[0] = 0.5; };
  return is_number && !std::is_integral_v<Value> ? text(info.range) : "";
}

/// Calls visit(part) for each part of any effect, with its default parameters, possibly more than
/// once.
template <class Visitor>
void for_each_part(const Visitor& visit) {
  for_each_kind([&](const auto& effect) {
    for_each_parameter(effect, [&]<class Value>(const ParameterInfo&, const Value&) {
      if constexpr (OptionalPart<Value>) visit(typename Value::value_type{});
    });
  });
}

template <class Struct>
py::list parameters_of(const Struct& defaults) {
  py::list result;
  for_each_parameter(defaults, [&]<class Value>(const ParameterInfo& info, const Value& value) {
    py::dict row;
    row["name"] = info.name;
    row["symbol"] = info.symbol;
    row["unit"] = info.unit;
    row["sentence"] = info.sentence;
    row["type"] = type_name(value);
    row["range"] = range_text<Value>(info);
    row["components"] = py::make_tuple(info.components[0], info.components[1]);
    row["required"] = info.required;
    row["default"] = info.required ? py::object(py::none()) : python(value);
    result.append(row);
  });
  return result;
}

py::list effect_descriptors() {
  py::list result;
  for_each_kind([&]<class Kind>(const Kind& effect) {
    py::dict row;
    row["name"] = Kind::info.name;
    row["kind"] = Kind::info.kind;
    row["sentence"] = Kind::info.sentence;
    row["law"] = Kind::info.law;
    row["source"] = Kind::info.source;
    row["account"] = account_name(Kind::info.account);
    row["bounds_joint"] = Kind::info.bounds_joint;
    row["jumps_or_sticks"] = Kind::info.jumps_or_sticks;
    row["moves_pivot"] = Kind::info.moves_pivot;
    row["is_function"] = Kind::info.is_function;
    row["damps_small_motions"] = Kind::info.damps_small_motions;
    row["examples"] = Kind::info.examples;
    row["outcome"] = Kind::info.outcome;
    row["parameters"] = parameters_of(effect);
    result.append(row);
  });
  return result;
}

py::list part_descriptors() {
  py::dict rows;
  for_each_part([&]<class Part>(const Part& part) {
    py::dict row;
    row["name"] = Part::name;
    row["sentence"] = Part::sentence;
    row["parameters"] = parameters_of(part);
    rows[py::str(Part::name)] = row;
  });
  return rows.attr("values")();
}

/// Whether each entry of the ledger is a loss.
py::dict accounts() {
  py::dict result;
  for (std::size_t i = 1; i < account_names.size(); ++i) {
    result[py::str(account_names[i])] = is_loss(static_cast<Account>(i));
  }
  return result;
}

void check_part(const std::string& where, const std::string& name, const py::dict& values) {
  bool found = false;
  for_each_part([&]<class Part>(Part part) {
    if (found || name != Part::name) return;
    found = true;
    fill(part, values);
    check_parameters(where, part);
  });
}

}  // namespace

Effect make_effect(py::handle kind_and_values) {
  const auto [kind, values] = kind_and_values.cast<KindAndValues>();
  if (kind == "user") {
    const auto [function, breaks] = values.cast<std::pair<py::object, std::vector<double>>>();
    return effect_of_function(function, breaks);
  }
  const py::dict named(values);
  return effect_of_kind(kind, [&](auto& given) { fill(given, named); });
}

py::tuple kind_and_values(const Effect& effect) {
  py::dict values;
  visit_parameters(effect, [&](const auto& given) { values = values_of(given); });
  return py::make_tuple(effect.info().kind, values);
}

void bind_effects(py::module_& module) {
  module.def("effect_descriptors", &effect_descriptors,
             "A dictionary for each kind of effect, with what is known of it.");
  module.def("part_descriptors", &part_descriptors,
             "A dictionary for each part of an effect that has parameters of its own.");
  module.def("accounts", &accounts,
             "The entries that a ledger may have, and whether each is a loss or work done.");
  module.def(
      "check_effect",
      [](const std::string& where, py::handle kind_and_values) {
        make_effect(kind_and_values)->check(where);
      },
      py::arg("where"), py::arg("kind_and_values"),
      "Raise a ValueError that begins with `where` for parameters out of their ranges.");
  module.def("check_part", &check_part, py::arg("where"), py::arg("name"), py::arg("values"),
             "Raise a ValueError for parameters of a part that are out of their ranges.");
}

}  // namespace pendcore::bindings
