#include "bind_effects.hpp"

#include <pybind11/stl.h>

#include "arguments.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/effects.hpp"
#include "python_function.hpp"

namespace pendcore::bindings {
namespace {

/// The name of a parameter's type in Python; a part has its own name.
template <class Value>
std::string_view type_name() {
  if constexpr (std::is_same_v<Value, bool>) {
    return "bool";
  } else if constexpr (std::is_same_v<Value, int>) {
    return "int";
  } else if constexpr (std::is_same_v<Value, double>) {
    return "float";
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    return "optional float";
  } else if constexpr (std::is_same_v<Value, std::array<double, 2>>) {
    return "pair";
  } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
    return "floats";
  } else if constexpr (std::is_same_v<Value, std::uintptr_t>) {
    return "address";
  } else {
    static_assert(OptionalPart<Value>, "teach this file the type of a new parameter");
    return Value::value_type::name;
  }
}

template <class Value>
std::string_view range_text(const ParameterInfo& info) {
  constexpr bool is_number =
      requires(Value value) { value = 0.5; } || requires(Value value) { value[0] = 0.5; };
  return is_number && !std::is_integral_v<Value> ? text(info.range) : "";
}

template <class Struct>
py::dict values_of(const Struct& given);

template <class Value>
py::object python(const Value& value) {
  if constexpr (OptionalPart<Value>) {
    return value ? py::object(values_of(*value)) : py::object(py::none());
  } else if constexpr (requires { value.begin(); }) {
    return py::tuple(py::cast(value));
  } else {
    return py::cast(value);
  }
}

template <class Struct>
py::dict values_of(const Struct& given) {
  py::dict result;
  for_each_parameter(given, [&](const ParameterInfo& info, const auto& value) {
    result[string(info.name)] = python(value);
  });
  return result;
}

template <class Struct>
void fill(Struct& filled, const py::dict& values) {
  for_each_parameter(filled, [&]<class Value>(const ParameterInfo& info, Value& value) {
    const py::str name = string(info.name);
    if (!values.contains(name)) return;
    const py::object given = values[name];
    if constexpr (OptionalPart<Value>) {
      value.reset();
      if (!given.is_none()) fill(value.emplace(), given.template cast<py::dict>());
    } else {
      value = given.template cast<Value>();
    }
  });
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
    row["name"] = string(info.name);
    row["symbol"] = string(info.symbol);
    row["unit"] = string(info.unit);
    row["sentence"] = string(info.sentence);
    row["type"] = string(type_name<Value>());
    row["range"] = string(range_text<Value>(info));
    row["components"] = py::make_tuple(string(info.components[0]), string(info.components[1]));
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
    row["name"] = string(Kind::info.name);
    row["kind"] = string(Kind::info.kind);
    row["sentence"] = string(Kind::info.sentence);
    row["law"] = string(Kind::info.law);
    row["source"] = string(Kind::info.source);
    row["account"] = string(account_name(Kind::info.account));
    row["bounds_joint"] = Kind::info.bounds_joint;
    row["jumps_or_sticks"] = Kind::info.jumps_or_sticks;
    row["moves_pivot"] = Kind::info.moves_pivot;
    row["is_function"] = Kind::info.is_function;
    row["damps_small_motions"] = Kind::info.damps_small_motions;
    row["examples"] = string(Kind::info.examples);
    row["outcome"] = string(Kind::info.outcome);
    row["parameters"] = parameters_of(effect);
    result.append(row);
  });
  return result;
}

py::list part_descriptors() {
  py::dict rows;
  for_each_part([&]<class Part>(const Part& part) {
    py::dict row;
    row["name"] = string(Part::name);
    row["sentence"] = string(Part::sentence);
    row["parameters"] = parameters_of(part);
    rows[string(Part::name)] = row;
  });
  return rows.attr("values")();
}

/// Whether each entry of the ledger is a loss.
py::dict accounts() {
  py::dict result;
  for (std::size_t i = 1; i < account_names.size(); ++i) {
    result[string(account_names[i])] = is_loss(static_cast<Account>(i));
  }
  return result;
}

void check_part_named(const std::string& name, const std::string& where, const py::dict& values) {
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
  const auto [kind, values] = kind_and_values.cast<std::pair<std::string, py::object>>();
  if (kind == "user") {
    const auto [function, breaks] = values.cast<std::pair<py::object, std::vector<double>>>();
    return effect_of_function(function, breaks);
  }
  return effect_of_kind(kind, [&](auto& given) { fill(given, values.cast<py::dict>()); });
}

py::tuple kind_and_values(const std::string& where, const Effect& effect) {
  if (effect.info().is_function) {
    throw py::type_error(where + "is a function: a run with it cannot be pickled or saved");
  }
  py::dict values;
  visit_parameters(effect, [&](const auto& given) { values = values_of(given); });
  return py::make_tuple(string(effect.info().kind), values);
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
  module.def(
      "check_part",
      [](const std::string& where, const std::string& name, const py::dict& values) {
        check_part_named(name, where, values);
      },
      py::arg("where"), py::arg("name"), py::arg("values"),
      "Raise a ValueError for parameters of a part that are out of their ranges.");
}

}  // namespace pendcore::bindings
