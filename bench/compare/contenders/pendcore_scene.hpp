// Makes a scene of what pendcore's programs are given.
#pragma once

#include <array>
#include <pendcore/pendcore.hpp>
#include <type_traits>

#include "program.hpp"

namespace contenders {

template <class Struct>
void fill(Struct& filled, const std::map<std::string, Numbers>& given, const std::string& where) {
  pendcore::for_each_parameter(filled, [&]<class Value>(const auto& info, Value& value) {
    const std::string name = where + std::string(info.name);
    if constexpr (pendcore::OptionalPart<Value>) {
      const auto part = given.lower_bound(name + '.');
      if (part != given.end() && part->first.starts_with(name + '.'))
        fill(value.emplace(), given, name + '.');
    } else if (const auto found = given.find(name); found != given.end()) {
      const Numbers& numbers = found->second;
      if constexpr (std::is_same_v<Value, Numbers>)
        value = numbers;
      else if constexpr (std::is_same_v<Value, std::array<double, 2>>)
        value = {numbers.at(0), numbers.at(1)};
      else if constexpr (std::is_convertible_v<double, Value>)
        value = static_cast<Value>(numbers.at(0));
      else
        throw Unsupported("not a number: " + name);
    }
  });
}

inline pendcore::Scene scene_of(const Given& given) {
  pendcore::Scene scene;
  scene.gravity = given["gravity"][0];
  for (std::size_t i = 0; i < given.n(); ++i)
    scene.links.push_back(pendcore::Link::uniform_rod(given["masses"][i], given["lengths"][i]));
  for (const auto& [kind, parameters] : given.effects)
    scene.effects.push_back(pendcore::effect_of_kind(
        kind, [&given = parameters](auto& effect) { fill(effect, given, ""); }));
  return scene;
}

}  // namespace contenders
