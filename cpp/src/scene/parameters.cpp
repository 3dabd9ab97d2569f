#include "pendcore/parameters.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include "effects/behaviour.hpp"

namespace pendcore {
namespace {

constexpr std::size_t first_link = 1;  // after gravity
constexpr std::size_t numbers_of_link = 4;
enum LinkNumber : std::uint8_t { mass, length, center, inertia };

struct LinkField {
  const char* name;
  const char* unit;
  double Link::* field;
};
constexpr std::array<LinkField, numbers_of_link> link_fields = {{
    {"mass", "kg", &Link::mass},
    {"length", "m", &Link::length},
    {"center", "m", &Link::center},
    {"inertia", "kg m^2", &Link::inertia},
}};

void change_effects(Scene& scene, const NumberVisitor& visit) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const std::string prefix = "effect[" + std::to_string(i + 1) + "].";
    scene.effects[i] = scene.effects[i]->with_numbers(
        [&](const std::string& part, const ParameterInfo& info, std::string_view component,
            double& number) { visit(prefix + part, info, component, number); });
  }
}

/// The number of single changes of letters between two words (Levenshtein's distance).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

/// Says what is wrong with the number of a link or an effect in a name; empty if it is right.
std::string wrong_number(const Scene& scene, const std::string& name) {
  for (const auto& [part, count] :
       {std::pair("link", scene.links.size()), std::pair("effect", scene.effects.size())}) {
    const std::string prefix = std::string(part) + "[";
    if (!name.starts_with(prefix)) continue;
    std::size_t number = 0;  // which stays 0 where there are no digits, or too many
    std::from_chars(name.data() + prefix.size(), name.data() + name.size(), number);
    if (number >= 1 && number <= count) continue;
    if (count == 0) return "it has no " + std::string(part) + "s";
    return "it has " + std::to_string(count) + " " + part + (count == 1 ? "" : "s") +
           ", counted from 1";
  }
  return "";
}

/// What to do about a name that the scene does not have.
std::string remedy(const Scene& scene, const std::vector<NamedNumber>& known,
                   const std::string& name, const std::vector<std::string>& others) {
  if (!others.empty() && !name.starts_with("link") && !name.starts_with("effect")) {
    const auto far = [&](const std::string& one) { return distance(one, name); };
    const std::string& nearest = *std::ranges::min_element(others, {}, far);
    if (far(nearest) <= nearest.size() / 2) return "did you mean \"" + nearest + "\"?";
  } else if (name.starts_with("q0") || name.starts_with("qd0")) {
    return "starts are not parameters: give them as q0 and qd0";
  }
  if (const std::string wrong = wrong_number(scene, name); !wrong.empty()) return wrong;
  const auto is_part = [&](const NamedNumber& one) { return one.name.starts_with(name + "."); };
  if (const auto part = std::ranges::find_if(known, is_part); part != known.end()) {
    return "did you mean \"" + part->name + "\"?";
  }
  // A right name may stand after a wrong one, as in link[1].damping: the last parts are compared.
  const auto last_part = [](const std::string& all) { return all.substr(all.rfind('.') + 1); };
  const std::string wanted = last_part(name);
  const auto far = [&](const NamedNumber& one) { return distance(last_part(one.name), wanted); };
  const std::size_t nearest = far(*std::ranges::min_element(known, {}, far));
  if (nearest > wanted.size() / 2) return "parameters() lists those that it has";
  // If there are several, the one whose whole name is nearest is meant.
  std::vector<NamedNumber> near;
  std::ranges::copy_if(known, std::back_inserter(near),
                       [&](const NamedNumber& one) { return far(one) == nearest; });
  const auto meant = std::ranges::min_element(
      near, {}, [&](const NamedNumber& one) { return distance(one.name, name); });
  return "did you mean \"" + meant->name + "\"?";
}

}  // namespace

std::vector<NamedNumber> parameters(const Scene& scene) {
  std::vector<NamedNumber> result{{"gravity", "m/s^2", scene.gravity}};
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    for (const auto& [name, unit, field] : link_fields) {
      result.push_back(
          {"link[" + std::to_string(i + 1) + "]." + name, unit, scene.links[i].*field});
    }
  }
  Scene copy = scene;
  change_effects(copy, [&](const std::string& part, const ParameterInfo& info,
                           std::string_view component, double number) {
    std::string name = part + std::string(info.name);
    if (!component.empty()) name += "." + std::string(component);
    result.push_back({std::move(name), std::string(info.unit), number});
  });
  return result;
}

std::vector<std::string> input_names(const Scene& scene) {
  std::vector<std::string> names{"pivot.x", "pivot.y"};
  for (std::size_t j = 1; j <= scene.links.size(); ++j) {
    names.push_back("torque[" + std::to_string(j) + "]");
  }
  return names;
}

ParameterChoice::ParameterChoice(const Scene& scene, const std::vector<std::string>& names,
                                 const std::vector<std::string>& others)
    : names_(names) {
  const std::vector<NamedNumber> known = parameters(scene);
  for (const std::string& name : names) {
    const auto found = std::ranges::find(known, name, &NamedNumber::name);
    if (found == known.end()) {
      throw std::invalid_argument("parameter \"" + name + "\": the scene has none of that name: " +
                                  remedy(scene, known, name, others));
    }
    places_.push_back(static_cast<std::size_t>(found - known.begin()));
    values_.push_back(found->value);
  }
}

void ParameterChoice::set(Scene& copy, std::span<const double> values) const {
  const std::size_t first_effect = first_link + numbers_of_link * copy.links.size();
  bool any_effect = false;
  bool any_link = false;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (places_[k] == 0) copy.gravity = values[k];
    any_link = any_link || (places_[k] >= first_link && places_[k] < first_effect);
    any_effect = any_effect || places_[k] >= first_effect;
  }
  for (std::size_t i = 0; any_link && i < copy.links.size(); ++i) {
    Link& link = copy.links[i];
    const Link rod = Link::uniform_rod(link.mass, link.length);
    const bool has_center_of_rod = link.center == rod.center;
    const bool has_inertia_of_rod = link.inertia == rod.inertia;
    std::array<bool, numbers_of_link> is_given{};
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const std::size_t number = places_[k] - first_link - numbers_of_link * i;
      if (places_[k] < first_link || number >= numbers_of_link) continue;
      link.*link_fields[number].field = values[k];
      is_given[number] = true;
    }
    const Link changed = Link::uniform_rod(link.mass, link.length);
    if (has_center_of_rod && !is_given[center]) link.center = changed.center;
    if (has_inertia_of_rod && !is_given[inertia]) link.inertia = changed.inertia;
  }
  if (!any_effect) return;
  std::size_t place = first_effect;
  change_effects(copy, [&](const std::string& /*part*/, const ParameterInfo& /*info*/,
                           std::string_view /*component*/, double& number) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (places_[k] == place) number = values[k];
    }
    ++place;
  });
}

Scene ParameterChoice::changed(const Scene& scene, std::size_t which, double value) const {
  Scene copy = scene;
  std::vector<double> values = values_;
  values[which] = value;
  set(copy, values);
  return copy;
}

}  // namespace pendcore
