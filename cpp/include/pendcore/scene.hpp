/// \file
/// The scene that is simulated: plain data, in SI units.
///
/// **The angle convention.** x points right, y points **down**, the origin is the pivot. `q_i` is
/// the absolute angle of link i from +x towards +y: q = 0 is horizontal, q = pi/2 hangs straight
/// down, q = -pi/2 stands upright. From the hanging vertical, counter-clockwise as seen:
/// theta = pi/2 - q. Links and joints count from 1; joint i is where link i begins.
///
///      A (pivot) o-----> x
///                |\  q_1
///                | \                   u_i = (cos q_i, sin q_i)    along link i
///                v  o B                n_i = (-sin q_i, cos q_i)   across it
///                y   \ q_2
///                     o D (tip)
///
/// The state is y = (q_1 .. q_n, qd_1 .. qd_n), rad and rad/s: 2n numbers.
#pragma once

#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include "pendcore/effects/effect.hpp"

namespace pendcore {

/// A rigid link between its proximal joint (towards the pivot) and its distal one.
struct Link {
  double mass = not_given;     ///< m, kg; > 0, or 0 where something else resists its rotation
  double length = not_given;   ///< L, m, from joint to joint; > 0
  double center = not_given;   ///< c, m, from the proximal joint to the mass centre, along the link
  double inertia = not_given;  ///< I, kg m^2, about the mass centre; >= 0

  /// The inertia about its own joint without the links beyond it, kg m^2: I + m c^2.
  double inertia_about_joint() const;

  static Link uniform_rod(double mass, double length);  ///< c = L/2, I = m L^2/12
  static Link point_mass(double mass, double length);   ///< all the mass at the distal end
};

/// A planar open chain hanging from a pivot, and the effects that act on it.
struct Scene {
  std::vector<Link> links;
  double gravity = 9.807;            ///< g, m/s^2, downward (+y)
  std::vector<Effect> effects = {};  ///< all of them act, in any number and order

  /// The double pendulum of section 2.1: two rods of 1 kg and 1 m, g = 9.807 m/s^2.
  static Scene textbook();
};

/// The effects of one kind, in their order.
template <class Kind>
auto effects_of(const Scene& scene) {
  return scene.effects | std::views::filter(&Effect::is<Kind>) |
         std::views::transform(
             [](const Effect& one) -> const Kind& { return *one.get_if<Kind>(); });
}

/// Throws std::invalid_argument, naming the link or effect, the field, the value, the allowed range
/// and the remedy, for a scene that has no motion: values that are not finite or out of range, or a
/// mass matrix that is singular somewhere.
void check(const Scene& scene);

/// Warnings of values that the equations allow but a workshop hardly has, a sentence each.
std::vector<std::string> plausibility_warnings(const Scene& scene);

/// The textbook's count of freedom, M = 3 n - 2 c5 - c4.
struct Mobility {
  int links;               ///< n, moving links
  int c5;                  ///< joints that leave one degree of freedom
  int c4;                  ///< joints that leave two
  int degrees_of_freedom;  ///< M
};
Mobility mobility(const Scene& scene);

}  // namespace pendcore
