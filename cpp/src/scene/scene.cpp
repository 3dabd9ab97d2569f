#include "pendcore/scene.hpp"

#include <algorithm>
#include <cmath>

#include "effects/behaviour.hpp"
#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/effects/payload.hpp"
#include "scene/degrees.hpp"
#include "scene/effects_of_scene.hpp"
#include "scene/singular.hpp"
#include "text/message.hpp"

namespace pendcore {
namespace {

std::string link_name(std::size_t i) { return "link " + std::to_string(i + 1); }

void check_link(const Link& link, std::size_t i) {
  const double m = link.mass;
  if (!(std::isfinite(m) && m >= 0)) {
    refuse(link_name(i) + ": mass", m,
           "finite and > 0 (kg), or 0 where something else resists its rotation");
  }
  if (!(std::isfinite(link.length) && link.length > 0)) {
    refuse(link_name(i) + ": length", link.length, "finite and > 0 (m)");
  }
  if (!std::isfinite(link.center)) {
    refuse(link_name(i) + ": center", link.center,
           "finite (m, from the proximal joint; half the length for a uniform rod)");
  }
  if (!(std::isfinite(link.inertia) && link.inertia >= 0)) {
    refuse(link_name(i) + ": inertia", link.inertia,
           "finite and >= 0 (kg m^2, about the mass centre; 0 for a point mass)");
  }
}

void check_place(const std::string& where, const char* what, int number, int n) {
  if (number <= n) return;
  std::string message = where + what + " = " + std::to_string(number);
  message += ": must be 1 to " + std::to_string(n) + ": the chain has " + std::to_string(n) + ' ';
  message += what;
  throw std::invalid_argument(n == 1 ? message : message + 's');
}

void check_effects(const Scene& scene) {
  if (scene.effects.empty()) return;
  const int n = static_cast<int>(scene.links.size());
  std::vector<bool> locked(n);
  std::vector<std::array<double, 2>> ranges(n, {-never, never});  // the room that stops leave
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const std::string where = effect_name(scene, i) + ": ";
    const EffectBehaviour& effect = *scene.effects[i];
    effect.check(where);
    const int joint = effect.joint();
    check_place(where, "joint", joint, n);
    check_place(where, "link", effect.link(), n);
    if (const JointStop* const stop = scene.effects[i].get_if<JointStop>()) {
      const auto [lower, upper] = stop->range;
      std::array<double, 2>& room = ranges[joint - 1];
      room = {std::max(room[0], lower), std::min(room[1], upper)};
      if (room[0] >= room[1]) {
        throw std::invalid_argument(where + "range = (" + text(lower) + ", " + text(upper) +
                                    "): must overlap the ranges of the other stops of joint " +
                                    std::to_string(joint) +
                                    " (rad): together they leave it no room; a Lock holds a "
                                    "joint at one angle");
      }
    }
    if (scene.effects[i].is<Lock>()) {
      if (locked[joint - 1]) {
        throw std::invalid_argument(where + "joint " + std::to_string(joint) +
                                    " is locked already: leave one of the two out");
      }
      locked[joint - 1] = true;
    }
  }
}

/// Adds a sentence for each angle of an effect that seems to be in degrees. A phase may be that
/// large, because it moves a wave in time.
void warn_of_degrees(const std::string& where, const EffectBehaviour& effect,
                     std::vector<std::string>& warnings) {
  effect.with_numbers([&](const std::string& part, const ParameterInfo& info,
                          std::string_view /*component*/, double x) {
    if (info.unit != "rad" || info.name == "phase") return;
    if (!may_be_degrees(x) || !is_large_angle(x)) return;
    warnings.push_back(warning_of_degrees(where + part + std::string(info.name), x));
  });
}

}  // namespace

Link Link::uniform_rod(double mass, double length) {
  return {mass, length, 0.5 * length, mass * length * length / 12.0};
}

double Link::inertia_about_joint() const { return inertia + mass * center * center; }

Link Link::point_mass(double mass, double length) { return {mass, length, length, 0.0}; }

Scene Scene::textbook() {
  return {.links = {Link::uniform_rod(1.0, 1.0), Link::uniform_rod(1.0, 1.0)}, .gravity = 9.807};
}

void check(const Scene& scene) {
  const std::size_t n = scene.links.size();
  if (n == 0) throw std::invalid_argument("links: none given: a scene has at least one link");
  if (!std::isfinite(scene.gravity)) {
    refuse("gravity", scene.gravity, "finite (m/s^2, downward; 0 switches it off)");
  }
  for (std::size_t i = 0; i < n; ++i) check_link(scene.links[i], i);

  check_effects(scene);
  double carried = 0.0;
  for (const Payload& payload : effects_of<Payload>(scene)) carried += payload.mass;
  for (std::size_t i = n; i-- > 0;) {
    const Link& link = scene.links[i];
    const double about_joint = link.inertia_about_joint() + link.length * link.length * carried;
    if (!std::isfinite(about_joint)) {
      refuse(link_name(i) + ": inertia about its joint, with what it carries,", about_joint,
             "finite (kg m^2): choose smaller masses or lengths");
    }
    carried += link.mass;
  }
  const std::string reason = singular_somewhere(scene);
  if (!reason.empty()) throw std::invalid_argument(reason);
}

std::vector<std::string> plausibility_warnings(const Scene& scene) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    const Link& link = scene.links[i];
    const double densest = 22590.0 * link.length * link.length * link.length;
    if (link.mass > densest) {
      warnings.push_back(link_name(i) + ": mass = " + text(link.mass) +
                         ": a cube of osmium as wide as the link is long has " + text(densest) +
                         " kg: is the mass in g, or the length in another unit?");
    }
    if (link.center < 0 || link.center > link.length) {
      warnings.push_back(link_name(i) + ": center = " + text(link.center) +
                         ": is not between the joints, 0 to " + text(link.length) +
                         " m: a counterweight, or another unit?");
    }
    const double most = link.mass * link.center * (link.length - link.center);
    if (link.center >= 0 && link.center <= link.length && link.inertia > most * (1 + 1e-12)) {
      warnings.push_back(
          link_name(i) + ": inertia = " + text(link.inertia) +
          ": no mass between its joints has more than m c (L - c) = " + text(most) +
          " kg m^2 about the mass centre: is it about the joint, or in other units?");
    }
  }
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const std::string where = effect_name(scene, i) + ": ";
    warn_of_degrees(where, *scene.effects[i], warnings);
    for (const std::string& warning : scene.effects[i]->warnings()) {
      warnings.push_back(where + warning);
    }
  }
  return warnings;
}

Mobility mobility(const Scene& scene) {
  const int n = static_cast<int>(scene.links.size());
  const std::vector<bool> locked = locked_joints(scene);
  // A lock makes two links one, or the first one part of the ground.
  const int moving = n - static_cast<int>(std::ranges::count(locked, true));
  return {.links = moving, .c5 = moving, .c4 = 0, .degrees_of_freedom = 3 * moving - 2 * moving};
}

}  // namespace pendcore
