#include "pendcore/scene.hpp"

#include <cmath>

#include "pendcore/message.hpp"

namespace pendcore {
namespace {

std::string link_name(std::size_t i) { return "link " + std::to_string(i + 1); }

void check_link(const Link& link, std::size_t i, bool last) {
  const double m = link.mass;
  if (last && !(std::isfinite(m) && m > 0)) {
    refuse(link_name(i) + ": mass", m, "finite and > 0 (kg)");
  }
  if (!(std::isfinite(m) && m >= 0)) {
    refuse(link_name(i) + ": mass", m,
           "finite and >= 0 (kg; 0 only where another link hangs on it)");
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

}  // namespace

Link Link::uniform_rod(double mass, double length) {
  return {mass, length, 0.5 * length, mass * length * length / 12.0};
}

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
  for (std::size_t i = 0; i < n; ++i) check_link(scene.links[i], i, i + 1 == n);

  double carried = 0.0;
  for (std::size_t i = n; i-- > 0;) {
    const Link& link = scene.links[i];
    const double about_joint = link.inertia_about_joint() + link.length * link.length * carried;
    if (!(about_joint > 0 && std::isfinite(about_joint))) {
      refuse(link_name(i) + ": inertia about its joint, with what it carries,", about_joint,
             "finite and > 0 (kg m^2): give it an inertia, or move its mass centre off the joint");
    }
    const bool next_is_a_point = i + 1 == n || scene.links[i + 1].inertia == 0;
    if (link.inertia_about_joint() == 0 && next_is_a_point) {
      throw std::invalid_argument(
          link_name(i) +
          ": has neither mass nor inertia about its joint: the mass matrix is singular when it "
          "lines up with the next link: give one of the two an inertia");
    }
    carried += link.mass;
  }
}

std::vector<std::string> plausibility_warnings(const Scene& scene) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    const Link& link = scene.links[i];
    const double most = link.mass * link.center * (link.length - link.center);
    if (link.center >= 0 && link.center <= link.length && link.inertia > most * (1 + 1e-12)) {
      warnings.push_back(
          link_name(i) + ": inertia = " + text(link.inertia) +
          ": no mass between its joints has more than m c (L - c) = " + text(most) +
          " kg m^2 about the mass centre: is it about the joint, or in other units?");
    }
  }
  return warnings;
}

Mobility mobility(const Scene& scene) {
  const int n = static_cast<int>(scene.links.size());
  return {.links = n, .c5 = n, .c4 = 0, .degrees_of_freedom = 3 * n - 2 * n};
}

}  // namespace pendcore
