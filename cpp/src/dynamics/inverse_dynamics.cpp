#include "dynamics/inverse_dynamics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "arithmetic/extrapolated_slope.hpp"
#include "arithmetic/instruction_set.hpp"
#include "arithmetic/sine_cosine.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/inertia.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"
#include "pendcore/parameters.hpp"

namespace pendcore {
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
    if (effect.moves_pivot) add_fields(effect.pivot);
    for (auto& wave : effect.waves) add(wave.angular_frequency, wave.phase);
  }
  return found;
}

/// A mechanism with the same effects, whose numbers are still to be set.
Mechanism<AlongParameters> with_slopes(const Mechanism<double>& plain) {
  using Number = AlongParameters;
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
    to.moves_pivot = from.moves_pivot;
    to.pivot.x.wave = from.pivot.x.wave;
    to.pivot.y.wave = from.pivot.y.wave;
    to.waves.resize(from.waves.size());
  }
  return result;
}

/// Whether a change of a limit cuts a table into other pieces: by the one that holds from time t,
/// in its middle, because its ends move.
bool has_other_pieces(const Scene& scene, const Scene& changed, double t, bool forward) {
  for (std::size_t i = 0; i < scene.effects.size(); ++i) {
    const EffectBehaviour& effect = *scene.effects[i];
    if (!std::isfinite(effect.last_time())) continue;
    const double next = effect.next_time(t, forward);
    const double within = std::isfinite(next) ? 0.5 * (t + next) : t;
    const auto mode = [&](const EffectBehaviour& one) {
      return one.mode_at(within, 0.0, 0.0, forward);
    };
    if (mode(*changed.effects[i]) != mode(effect)) return true;
  }
  return false;
}

/// The slopes of all numbers of a mechanism along one of some parameters, which have these values.
std::vector<double> slopes_along(const Scene& scene, const std::vector<int>& modes, double t,
                                 bool forward, const ParameterChoice& choice,
                                 std::vector<double> values, const std::vector<std::string>& names,
                                 std::size_t which) {
  const double value = values[which];
  Mechanism<double> here = mechanism(scene, modes);
  const std::vector<double*> numbers = numbers_of(here);
  const auto numbers_at = [&](double at) {
    Scene copy = scene;
    values[which] = at;
    choice.set(copy, values);
    std::vector<double> result;
    if (has_other_pieces(scene, copy, t, forward)) return result;
    Mechanism<double> there = mechanism(copy, modes);
    result.reserve(numbers.size());
    for (const double* each : numbers_of(there)) result.push_back(*each);
    return result;
  };
  std::vector<double> slopes(numbers.size());
  const auto take_slopes = [&](double h) {
    std::array<std::vector<double>, steps_of_slope> ahead, behind;
    for (int k = 0; k < steps_of_slope; ++k) {
      ahead[k] = numbers_at(value + std::ldexp(h, -k));
      behind[k] = numbers_at(value - std::ldexp(h, -k));
      if (ahead[k].empty() || behind[k].empty()) return false;
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const auto slope = extrapolated_slope(
          *numbers[i], {ahead[0][i], ahead[1][i], ahead[2][i], ahead[3][i]},
          {behind[0][i], behind[1][i], behind[2][i], behind[3][i]}, h, std::abs(value));
      if (!slope) return false;
      slopes[i] = *slope;
    }
    return true;
  };
  // An infinite limit stays so, and changes nothing. The steps are powers of two, so that they are
  // exact, and shrink where a corner is near.
  double h = value == 0.0 ? 1.0 : std::ldexp(1.0, std::ilogb(value) - 4);
  const double smallest = 0x1p-20 * h;
  while (std::isfinite(value) && !take_slopes(h)) {
    h *= 0x1p-4;
    if (h >= smallest) continue;
    throw std::invalid_argument("parameter \"" + names[which] +
                                "\": a law has a corner at this value: there is no derivative by "
                                "it; it has one at a slightly larger or smaller value");
  }
  return slopes;
}

}  // namespace

std::vector<int> modes_at(const Scene& scene, double t, const double* q, const double* qd) {
  std::vector<int> modes;
  for (const Effect& effect : scene.effects) modes.push_back(mode_at(*effect, t, q, qd, true));
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
    if (const std::optional<PivotLaw> pivot = effect.pivot_law(modes[i])) {
      acting.moves_pivot = true;
      acting.pivot = *pivot;
    }
    for (const Sinusoid& wave : effect.waves()) {
      acting.waves.push_back({wave.angular_frequency, wave.phase});
    }
  }
  return result;
}

std::vector<Mechanism<AlongParameters>> mechanisms_along(const Scene& scene,
                                                         const std::vector<int>& modes, double t,
                                                         bool forward,
                                                         const std::vector<std::string>& names) {
  const ParameterChoice choice(scene, names);
  const std::vector<NamedNumber> known = parameters(scene);
  std::vector<double> values;
  values.reserve(names.size());
  for (const std::string& name : names) {
    values.push_back(std::ranges::find(known, name, &NamedNumber::name)->value);
  }
  Mechanism<double> here = mechanism(scene, modes);
  std::vector<Mechanism<AlongParameters>> result;
  for (std::size_t which = 0; which < names.size(); ++which) {
    const std::size_t lane = which % parameters_at_once;
    if (lane == 0) {
      result.push_back(with_slopes(here));
      const std::vector<AlongParameters*> duals = numbers_of(result.back());
      const std::vector<double*> numbers = numbers_of(here);
      for (std::size_t i = 0; i < duals.size(); ++i) {
        *duals[i] = AlongParameters(*numbers[i]);
      }
    }
    const std::vector<double> slopes =
        slopes_along(scene, modes, t, forward, choice, values, names, which);
    const std::vector<AlongParameters*> duals = numbers_of(result.back());
    for (std::size_t i = 0; i < duals.size(); ++i) {
      set_lane(duals[i]->slope, static_cast<int>(lane), slopes[i]);
    }
  }
  return result;
}

template <class Number>
void InverseDynamics<Number>::compute(const Mechanism<Number>& mechanism, double t,
                                      const Numbers& q, const Numbers& qd, const Numbers& qdd) {
  const auto n = static_cast<int>(mechanism.bodies.size());
  sine_.resize(n);
  cosine_.resize(n);
  sine_cosine(q.data(), n, sine_.data(), cosine_.data());
  waves_.assign(mechanism.effects.size(), {});
  at_.resize(n);
  inertial_.resize(n);
  loads_.assign(n, {});
  torques_.resize(n);
  forces_.resize(n);
  on_this_processor<&InverseDynamics::go_out_and_back>(this, &mechanism, t, q.data(), qd.data(),
                                                       qdd.data());
}

template <class Number>
PENDCORE_INLINE void InverseDynamics<Number>::go_out_and_back(InverseDynamics* self,
                                                              const Mechanism<Number>* mechanism,
                                                              double t, const double* q,
                                                              const double* qd, const double* qdd) {
  using Vector2 = Planar<Number>;
  const auto constant = [](double x) { return Constants<Number>::of(x); };
  const auto n = static_cast<int>(mechanism->bodies.size());
  const double* const sine = self->sine_.data();
  const double* const cosine = self->cosine_.data();

  // The waves, and the motion of the pivot.
  Vector2 velocity, acceleration;
  for (std::size_t e = 0; e < mechanism->effects.size(); ++e) {
    const auto& effect = mechanism->effects[e];
    auto& [s, c] = self->waves_[e];
    for (std::size_t k = 0; k < effect.waves.size(); ++k) {
      const Number angle = t * effect.waves[k].angular_frequency + effect.waves[k].phase;
      sine_cosine(angle, s[k], c[k]);
    }
    if (!effect.moves_pivot) continue;
    effect.pivot.add_acceleration(constant(t), s, acceleration.x, acceleration.y);
    effect.pivot.add_velocity(constant(t), c, velocity.x, velocity.y);
  }

  // From the pivot to the tip: where each joint goes, and what it takes to move each link.
  acceleration.y = acceleration.y - mechanism->gravity;
  for (int i = 0; i < n; ++i) {
    const auto& body = mechanism->bodies[i];
    self->at_[i] = {.t = t,
                    .q = constant(q[i]),
                    .qd = constant(qd[i]),
                    .s = constant(sine[i]),
                    .c = constant(cosine[i]),
                    .L = body.length,
                    .angle = constant(relative(q, i + 1)),
                    .rate = constant(relative(qd, i + 1)),
                    .vx_of_joint = velocity.x,
                    .vy_of_joint = velocity.y};
    velocity = {velocity.x - (qd[i] * sine[i]) * body.length,
                velocity.y + (qd[i] * cosine[i]) * body.length};
    const double square = qd[i] * qd[i];
    const double x = -qdd[i] * sine[i] - square * cosine[i];  // of an arm of 1 m
    const double y = qdd[i] * cosine[i] - square * sine[i];
    self->inertial_[i] = {body.mass * (acceleration.x + x * body.center),
                          body.mass * (acceleration.y + y * body.center)};
    acceleration = {acceleration.x + x * body.length, acceleration.y + y * body.length};
  }

  for (std::size_t e = 0; e < mechanism->effects.size(); ++e) {
    const auto& [place, couple, law, moves_pivot, pivot, waves] = mechanism->effects[e];
    RowLoads<Number>& loads = self->loads_[place];
    if (couple) {
      loads.couple(couple->torque(t, relative(q, place + 1), relative(qd, place + 1),
                                  self->waves_[e].sine[0]));
    } else if (law) {
      std::visit([&](const auto& one) { one.add(self->at_[place], loads); }, *law);
    }
  }

  // From the tip to the pivot.
  Vector2 beyond{mechanism->payload_mass * acceleration.x,
                 mechanism->payload_mass * acceleration.y};  // F_{i,i+1}
  Number torque = qdd[n - 1] * mechanism->payload_inertia;
  for (int i = n; i-- > 0;) {
    const auto& body = mechanism->bodies[i];
    const RowLoads<Number>& loads = self->loads_[i];
    const Vector2& inertial = self->inertial_[i];
    const auto across = [&](const Vector2& force) __attribute__((always_inline)) {
      return cosine[i] * force.y - sine[i] * force.x;
    };
    torque = torque + qdd[i] * body.inertia + body.center * across(inertial) +
             body.length * across(beyond) - loads.moments;
    beyond = {beyond.x + inertial.x - loads.fx, beyond.y + inertial.y - loads.fy};
    self->forces_[i] = beyond;
    self->torques_[i] = torque + relative(qdd, i + 1) * body.armature - loads.couples;
  }
}

template class InverseDynamics<double>;
template class InverseDynamics<AlongParameters>;

void ChangesOfAccelerations::compute(const std::vector<Mechanism<AlongParameters>>& mechanisms,
                                     double t, const Numbers& q, const Numbers& qd,
                                     const Numbers& qdd, JointForces& forces,
                                     Eigen::Ref<Matrix> changes) {
  const std::size_t m = forces.joints.size();
  torques_.resize(m);
  change_.resize(q.size());
  for (std::size_t p = 0; p < mechanisms.size(); ++p) {
    motion_.compute(mechanisms[p], t, q, qd, qdd);
    for (std::size_t k = 0; k < parameters_at_once; ++k) {
      const auto column = static_cast<Eigen::Index>(p * parameters_at_once + k);
      if (column >= changes.cols()) break;
      for (std::size_t r = 0; r < m; ++r) {
        torques_[r] = -lane(motion_.torques()[forces.joints[r]].slope, static_cast<int>(k));
      }
      forces.respond(torques_.data(), change_.data());
      changes.col(column) = change_;
    }
  }
}

}  // namespace pendcore
