#include "scene/singular.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "pendcore/effects/joint_stop.hpp"
#include "pendcore/effects/lock.hpp"
#include "pendcore/effects/payload.hpp"
#include "pendcore/effects/rotor_inertia.hpp"

namespace pendcore {
namespace {

constexpr double half_turn = 3.141592653589793;
/// The square of a sine below this one is lost in the rounding of a mass matrix.
constexpr double lost_sine = 1e-7;

using Plane = std::complex<double>;

/// Links that locks make one, seen from the first of them.
struct Body {
  int first = 0;  ///< its first link, from 0
  int links = 0;
  bool has_rotor = false;
  double mass = 0.0, inertia = 0.0;  ///< the inertia is about the mass centre
  Plane center{}, reach{};           ///< from its joint to the mass centre, and to the next joint
  double size = 0.0;                 ///< the sum of the lengths
  double turn = 0.0;                 ///< the angle of the last link
  bool is_known = true;              ///< whether all its locks have angles

  /// What rounding may leave of a distance that is zero. A link alone has none.
  double slack() const { return links == 1 ? 0.0 : lost_sine * size; }
};

/// The motions without energy: low |omega| <= rho <= high |omega|.
struct Motions {
  double low, high;
  /// Where the joint of the body moves only across an axis: the angle of that axis in its frame.
  std::optional<double> axis = std::nullopt;
  bool is_turned_by_rotor = false;

  bool contain(double ratio, double slack) const {
    if (high > 0.0 && high < never) slack = std::max(slack, lost_sine * (high + ratio));
    return low - slack <= ratio && ratio <= high + slack;
  }
};
constexpr Motions joint_rests{0.0, 0.0};
constexpr Motions any_motion{0.0, never};
constexpr Motions no_rotation{never, never};
constexpr Motions no_motion{never, -1.0};

std::vector<Body> bodies_of(const Scene& scene) {
  const std::size_t n = scene.links.size();
  std::vector<const Lock*> lock(n, nullptr);
  for (const Lock& one : effects_of<Lock>(scene)) lock[one.joint - 1] = &one;
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < n;) {
    Body body{.first = static_cast<int>(i)};
    const bool is_ground = lock[i] != nullptr;
    for (const RotorInertia& rotor : effects_of<RotorInertia>(scene)) {
      body.has_rotor |= rotor.joint == body.first + 1 && rotor.armature > 0;
    }
    Plane moment;
    double square = 0.0;
    do {
      const Link& link = scene.links[i];
      if (body.links++ > 0) {
        body.turn += lock[i]->angle.value_or(0.0);
        body.is_known &= lock[i]->angle.has_value();
      }
      const Plane along = body.links == 1 ? 1.0 : std::polar(1.0, body.turn);
      const Plane center = body.reach + link.center * along;
      body.mass += link.mass;
      body.inertia += link.inertia;
      moment += link.mass * center;
      square += link.mass * std::norm(center);
      body.reach += link.length * along;
      body.size += link.length;
      ++i;
    } while (i < n && lock[i] != nullptr);
    if (body.mass > 0.0) body.center = moment / body.mass;
    if (body.links == 1) {
      body.center = scene.links[body.first].center;
    } else {
      const double apart = square - body.mass * std::norm(body.center);
      if (apart > lost_sine * lost_sine * square) body.inertia += apart;
    }
    if (i == n) {
      for (const Payload& payload : effects_of<Payload>(scene)) body.inertia += payload.inertia;
    }
    if (!is_ground) bodies.push_back(body);
  }
  return bodies;
}

/// Whether stops let a body bring a direction into line with the axis of the next body.
bool may_align(const Scene& scene, const Body& body, const Plane& direction, const Motions& next) {
  if (!next.axis || std::abs(direction) <= body.slack()) return true;
  const int joint = body.first + body.links + 1;
  double lower = -never;
  double upper = never;
  for (const JointStop& stop : effects_of<JointStop>(scene)) {
    if (stop.joint != joint) continue;
    lower = std::max(lower, stop.range[0]);
    upper = std::min(upper, stop.range[1]);
  }
  if (!std::isfinite(lower) || !std::isfinite(upper)) return true;
  // Both bodies turn at the rate of a rotor between them, so that they must be folded.
  const double period = next.is_turned_by_rotor ? 2.0 * half_turn : half_turn;
  const double aligned = std::arg(direction) - body.turn - *next.axis + half_turn;
  const double turns = std::ceil((lower - lost_sine - aligned) / period);
  return aligned + turns * period <= upper + lost_sine;
}

/// The motions of a body that has no rotation of its own without energy.
Motions at_rest(const Body& body, const Motions& next) {
  const bool moves = body.mass == 0.0 && next.high == never;
  if (body.has_rotor) return moves ? no_rotation : no_motion;
  return moves ? any_motion : joint_rests;
}

/// The motions of a body and of all beyond it, from those beyond it; none if the body turns while
/// its joint rests.
std::optional<Motions> with_body(const Scene& scene, const Body& body, const Motions& next) {
  if (body.inertia > 0.0) return at_rest(body, next);
  const double slack = body.slack();
  if (body.mass > 0.0) {
    double arm = std::abs(body.center);
    if (arm <= slack || !(body.mass * arm * arm > 0.0)) arm = 0.0;
    const Plane beyond = arm > 0.0 ? body.reach - body.center : body.reach;
    const bool turns =
        next.contain(std::abs(beyond), slack) && may_align(scene, body, beyond, next);
    if (!turns) return at_rest(body, next);
    if (body.has_rotor) return Motions{arm, arm, std::arg(body.center), true};
    if (arm == 0.0) return std::nullopt;
    return Motions{0.0, never, std::arg(body.center)};
  }
  const double length = std::abs(body.reach);
  const bool next_rests = next.low == 0.0 && next.high == 0.0;
  const auto axis = next_rests ? std::optional(std::arg(body.reach)) : std::nullopt;
  if (body.has_rotor) {
    if (next.high < 0.0) return no_motion;
    return Motions{std::max({next.low - length, length - next.high, 0.0}), next.high + length, axis,
                   true};
  }
  if (next.contain(length, slack) && may_align(scene, body, body.reach, next)) return std::nullopt;
  return next.high < 0.0 ? joint_rests : Motions{0.0, never, axis};
}

std::string why_singular(const Body& body, const Motions& next) {
  const std::string link = "link " + std::to_string(body.first + 1);
  const bool is_free_beyond = next.high == never && !next.axis;
  if (!is_free_beyond) {
    return link +
           ": has neither mass nor inertia about its joint: the mass matrix is singular when it "
           "lines up with link " +
           std::to_string(body.first + body.links + 1) +
           ": give one of the two an inertia; one massless rod with a mass at its end is "
           "Link.point_mass(mass=..., length=...)";
  }
  if (body.mass > 0.0) {
    return link +
           ": inertia about its joint, with what it carries, = 0.0: must be finite and > 0 (kg "
           "m^2): give it an inertia, or move its mass centre off the joint; "
           "Link.point_mass(mass=..., length=...) has it at the other end";
  }
  return link +
         ": mass = 0.0: must be finite and > 0 (kg), as nothing else resists its rotation, no "
         "inertia, payload or rotor; a massless rod with a mass at its end is "
         "Link.point_mass(mass=..., length=...)";
}

}  // namespace

std::string singular_somewhere(const Scene& scene) {
  // Links that all resist their own rotation leave no motion without energy.
  const auto resists = [](const Link& one) { return one.inertia > 0.0; };
  if (std::ranges::all_of(scene.links, resists)) return {};
  const bool has_payload = std::ranges::any_of(
      effects_of<Payload>(scene), [](const Payload& payload) { return payload.mass > 0.0; });
  Motions motions = has_payload ? joint_rests : any_motion;
  const std::vector<Body> bodies = bodies_of(scene);
  for (std::size_t i = bodies.size(); i-- > 0;) {
    if (!bodies[i].is_known) return {};
    const auto found = with_body(scene, bodies[i], motions);
    if (!found) return why_singular(bodies[i], motions);
    motions = *found;
  }
  return {};
}

}  // namespace pendcore
