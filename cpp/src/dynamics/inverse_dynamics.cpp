#include "dynamics/inverse_dynamics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "arithmetic/sine_cosine.hpp"
#include "dynamics/inertia.hpp"
#include "dynamics/kinematics.hpp"
#include "dynamics/row.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/parameters.hpp"

namespace pendcore {
/// What laws see of one link or joint (effects/laws.hpp).
template <class Number>
struct LinkAt {
  using Value = Number;
  double t;
  Number q, qd, s, c, L;
  Number angle, rate;               ///< of the joint
  Number vx_of_joint, vy_of_joint;  ///< m/s

  const Number& phi() const { return angle; }
  const Number& phid() const { return rate; }
  const Number& length() const { return L; }
  const Number& vx() const { return vx_of_joint; }
  const Number& vy() const { return vy_of_joint; }
};

/// A vector in the plane.
template <class Number>
struct Planar {
  Number x{}, y{};

  friend Planar operator+(const Planar& a, const Planar& b) { return {a.x + b.x, a.y + b.y}; }
  friend Planar operator-(const Planar& a, const Planar& b) { return {a.x - b.x, a.y - b.y}; }
  friend Planar operator*(const Number& k, const Planar& a) { return {k * a.x, k * a.y}; }
};

namespace {

/// All numbers of a mechanism, in one order.
template <class Number>
std::vector<Number*> numbers_of(Mechanism<Number>& all) {
  std::vector<Number*> found = {&all.gravity, &all.payload_mass, &all.payload_inertia};
  const auto add = [&](auto&... each) { (found.push_back(&each), ...); };
  const auto add_fields = [&](auto& constants) {
    each_field(constants, constants, [&](Number& each, const Number&) { add(each); });
  };
  for (auto& body : all.bodies) {
    add(body.mass, body.length, body.center, body.inertia, body.armature);
  }
  for (auto& effect : all.effects) {
    if (effect.couple) {
      add_fields(*effect.couple);
      add(effect.couple->gain);
    }
    if (effect.law) {
      std::visit(
          [&]<class Law>(Law& law) {
            add_fields(law);
            std::apply(add, Law::shared(law));
          },
          *effect.law);
    }
    if (effect.pivot) add_fields(*effect.pivot);
    for (auto& wave : effect.waves) add(wave.angular_frequency, wave.phase);
  }
  return found;
}

/// A mechanism with the same effects, whose numbers are still to be set.
Mechanism<Dual<double>> with_slopes(const Mechanism<double>& plain) {
  using Number = Dual<double>;
  Mechanism<Number> result;
  result.bodies.resize(plain.bodies.size());
  for (const auto& from : plain.effects) {
    auto& to = result.effects.emplace_back();
    to.place = from.place;
    if (from.couple) to.couple.emplace();
    if (from.law) {
      to.law = std::visit([]<template <class> class Law>(
                              const Law<double>& /*law*/) { return LawOn<Number>(Law<Number>{}); },
                          *from.law);
    }
    if (from.pivot) {
      to.pivot.emplace();
      to.pivot->x.wave = from.pivot->x.wave;
      to.pivot->y.wave = from.pivot->y.wave;
    }
    to.waves.resize(from.waves.size());
  }
  return result;
}

/// Throws for a limit that cuts a table into other pieces when it changes a little.
void require_same_pieces(const Scene& scene, const Scene& changed, const std::vector<int>& modes,
                         double t, const std::string& name) {
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const bool has_table = std::isfinite(scene.effects[i]->last_time());
    if (!has_table || changed.effects[i]->mode_at(t, 0.0, 0.0, true) == modes[i]) continue;
    throw std::invalid_argument(
        "parameter \"" + name +
        "\": it cuts the table into other pieces close to this value, where "
        "its derivative is not computed: choose a time or a value farther "
        "from where the table meets its limit");
  }
}

}  // namespace

std::vector<int> modes_at(const Scene& scene, double t, const double* q, const double* qd) {
  std::vector<int> modes;
  for (const Effect& effect : scene.effects) {
    const int joint = effect->joint();
    modes.push_back(effect->mode_at(t, joint > 0 ? relative(q, joint) : 0.0,
                                    joint > 0 ? relative(qd, joint) : 0.0, true));
  }
  return modes;
}

Mechanism<double> mechanism(const Scene& scene, const std::vector<int>& modes) {
  const Inertia inertia(scene);
  Mechanism<double> result{.gravity = scene.gravity,
                           .payload_mass = inertia.payload_mass,
                           .payload_inertia = inertia.payload_inertia};
  for (std::size_t i = 0; i < scene.links.size(); ++i) {
    const Link& link = scene.links[i];
    result.bodies.push_back(
        {link.mass, link.length, link.center, link.inertia, inertia.links[i].rotor});
  }
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    auto& acting = result.effects.emplace_back();
    acting.place = std::max({effect.joint(), effect.link(), 1}) - 1;
    const Link& link = scene.links[acting.place];
    acting.law = effect.law(modes[i], {link.mass, link.length, link.center, scene.gravity});
    if (!acting.law) acting.couple = effect.couple(modes[i]);
    acting.pivot = effect.pivot_law(modes[i]);
    for (const Sinusoid& wave : effect.waves()) {
      acting.waves.push_back({wave.angular_frequency, wave.phase});
    }
  }
  return result;
}

Mechanism<Dual<double>> mechanism_along(const Scene& scene, const std::vector<int>& modes, double t,
                                        const std::string& parameter) {
  const ParameterChoice choice(scene, {parameter});
  const std::vector<NamedNumber> known = parameters(scene);
  const double value = std::ranges::find(known, parameter, &NamedNumber::name)->value;
  Mechanism<double> here = mechanism(scene, modes);
  const std::vector<double*> numbers = numbers_of(here);
  const auto numbers_at = [&](double at) {
    Scene copy = scene;
    choice.set(copy, {&at, 1});
    Mechanism<double> there = mechanism(copy, modes);
    require_same_pieces(scene, copy, modes, t, parameter);
    std::vector<double> result;
    for (const double* each : numbers_of(there)) result.push_back(*each);
    return result;
  };
  // Richardson's extrapolation of central differences with steps h, h/2, h/4 and h/8.
  constexpr int levels = 4;
  // A limit that is infinite stays so, and none of its neighbours matters.
  double h = value == 0.0 || std::isinf(value) ? 1.0 : 0x1p-4 * std::abs(value);
  std::array<std::vector<double>, levels> slopes;
  for (std::vector<double>& slope : slopes) {
    slope = numbers_at(value + h);
    const std::vector<double> before = numbers_at(value - h);
    for (std::size_t i = 0; i < slope.size(); ++i) {
      slope[i] = (slope[i] - before[i]) / (std::isinf(value) ? never : (value + h) - (value - h));
    }
    h *= 0.5;
  }
  double weight = 4.0;
  for (int level = 1; level < levels; ++level, weight *= 4.0) {
    for (int k = levels - 1; k >= level; --k) {
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        slopes[k][i] += (slopes[k][i] - slopes[k - 1][i]) / (weight - 1.0);
      }
    }
  }
  Mechanism<Dual<double>> result = with_slopes(here);
  const std::vector<Dual<double>*> duals = numbers_of(result);
  for (std::size_t i = 0; i < duals.size(); ++i) {
    *duals[i] = {*numbers[i], slopes[levels - 1][i]};
  }
  return result;
}

template <class Number>
std::vector<Number> torques_of_motion(const Mechanism<Number>& mechanism, double t,
                                      const Numbers& q, const Numbers& qd, const Numbers& qdd) {
  using Vector2 = Planar<Number>;
  const auto n = static_cast<int>(mechanism.bodies.size());
  std::vector<double> sine(n), cosine(n);
  pendcore::sine_cosine(q.data(), n, sine.data(), cosine.data());

  // The waves, and the motion of the pivot.
  std::vector<std::vector<Number>> sines, cosines;
  Vector2 velocity, acceleration;
  for (const auto& effect : mechanism.effects) {
    auto& s = sines.emplace_back(std::max<std::size_t>(effect.waves.size(), 1));
    auto& c = cosines.emplace_back(s.size());
    for (std::size_t k = 0; k < effect.waves.size(); ++k) {
      const Number angle = t * effect.waves[k].angular_frequency + effect.waves[k].phase;
      sine_cosine(angle, s[k], c[k]);
    }
    if (!effect.pivot) continue;
    effect.pivot->add_acceleration(Number(t), s, acceleration.x, acceleration.y);
    effect.pivot->add_velocity(Number(t), c, velocity.x, velocity.y);
  }

  // From the pivot to the tip: where each joint goes, and what it takes to move each link.
  std::vector<LinkAt<Number>> at;
  std::vector<Vector2> inertial;  // m (a_C - g e_y)
  acceleration.y -= mechanism.gravity;
  for (int i = 0; i < n; ++i) {
    const auto& body = mechanism.bodies[i];
    at.push_back({.t = t,
                  .q = q[i],
                  .qd = qd[i],
                  .s = sine[i],
                  .c = cosine[i],
                  .L = body.length,
                  .angle = relative(q.data(), i + 1),
                  .rate = relative(qd.data(), i + 1),
                  .vx_of_joint = velocity.x,
                  .vy_of_joint = velocity.y});
    velocity = velocity + body.length * Vector2{-qd[i] * sine[i], qd[i] * cosine[i]};
    const double square = qd[i] * qd[i];
    const Vector2 of_unit_length{-qdd[i] * sine[i] - square * cosine[i],
                                 qdd[i] * cosine[i] - square * sine[i]};
    inertial.push_back(body.mass * (acceleration + body.center * of_unit_length));
    acceleration = acceleration + body.length * of_unit_length;
  }

  std::vector<RowLoads<Number>> loads(n);
  for (std::size_t e = 0; e < mechanism.effects.size(); ++e) {
    const auto& [place, couple, law, pivot, waves] = mechanism.effects[e];
    if (couple) {
      loads[place].couple(couple->torque(t, relative(q.data(), place + 1),
                                         relative(qd.data(), place + 1), sines[e].front()));
    } else if (law) {
      std::visit([&](const auto& one) { one.add(at[place], loads[place]); }, *law);
    }
  }

  // From the tip to the pivot.
  std::vector<Number> torques(n);
  Vector2 beyond = mechanism.payload_mass * acceleration;  // F_{i,i+1}
  Number torque = mechanism.payload_inertia * Number(qdd[n - 1]);
  for (int i = n; i-- > 0;) {
    const auto& body = mechanism.bodies[i];
    const auto across = [&](const Vector2& force) {
      return cosine[i] * force.y - sine[i] * force.x;
    };
    torque += body.inertia * Number(qdd[i]) + body.center * across(inertial[i]) +
              body.length * across(beyond) - loads[i].moments;
    beyond = beyond + inertial[i] - Vector2{loads[i].fx, loads[i].fy};
    torques[i] = torque + relative(qdd.data(), i + 1) * body.armature - loads[i].couples;
  }
  return torques;
}

template std::vector<double> torques_of_motion(const Mechanism<double>& mechanism, double t,
                                               const Numbers& q, const Numbers& qd,
                                               const Numbers& qdd);
template std::vector<Dual<double>> torques_of_motion(const Mechanism<Dual<double>>& mechanism,
                                                     double t, const Numbers& q, const Numbers& qd,
                                                     const Numbers& qdd);

}  // namespace pendcore
