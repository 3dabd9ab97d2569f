#include "dynamics/mechanism.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "arithmetic/extrapolated_slope.hpp"
#include "dynamics/equations_of_motion.hpp"
#include "dynamics/inertia.hpp"
#include "dynamics/kinematics.hpp"
#include "effects/behaviour.hpp"

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

std::vector<double> values_of(Mechanism<double> all) {
  std::vector<double> values;
  for (const double* each : numbers_of(all)) values.push_back(*each);
  return values;
}

/// A mechanism with the same effects, whose numbers are still to be set.
template <class Number>
Mechanism<Number> alike(const Mechanism<double>& plain) {
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

/// The slopes of all numbers of a mechanism, which are `numbers`, along one of some parameters;
/// nothing where a law has a corner.
std::optional<std::vector<double>> slopes_along(const Scene& scene, const std::vector<int>& modes,
                                                const std::vector<double>& numbers, double t,
                                                bool forward, const ParameterChoice& choice,
                                                std::size_t which) {
  const double value = choice.values()[which];
  const auto numbers_at = [&](double at) {
    const Scene changed = choice.changed(scene, which, at);
    if (has_other_pieces(scene, changed, t, forward)) return std::vector<double>{};
    return values_of(mechanism(changed, modes));
  };
  std::vector<double> slopes(numbers.size());
  const auto take_slopes = [&](double h) {
    std::array<std::vector<double>, steps_of_slope> ahead, behind;
    const auto take_numbers = [&](int k) {
      ahead[k] = numbers_at(value + std::ldexp(h, -k));
      behind[k] = numbers_at(value - std::ldexp(h, -k));
      return !ahead[k].empty() && !behind[k].empty();
    };
    if (!take_numbers(0) || !take_numbers(1)) return false;
    std::size_t linear = 0;  // most numbers are so in most parameters
    for (; linear < numbers.size(); ++linear) {
      const std::size_t i = linear;
      const auto slope =
          slope_of_line(numbers[i], {ahead[0][i], ahead[1][i]}, {behind[0][i], behind[1][i]}, h);
      if (!slope) break;
      slopes[i] = *slope;
    }
    if (linear == numbers.size()) return true;
    if (!take_numbers(2) || !take_numbers(3)) return false;
    for (std::size_t i = linear; i < numbers.size(); ++i) {
      const auto slope = extrapolated_slope(
          numbers[i], {ahead[0][i], ahead[1][i], ahead[2][i], ahead[3][i]},
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
    if (h < smallest) return std::nullopt;
  }
  return slopes;
}

}  // namespace

std::vector<int> modes_at(const Scene& scene, double t, const double* q, const double* qd) {
  std::vector<int> modes;
  modes.reserve(scene.effects.size());
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

MechanismAlong::MechanismAlong(const Scene& scene, const std::vector<int>& modes, double t,
                               bool forward, const ParameterChoice& choice)
    : names_(choice.names()), here_(mechanism(scene, modes)) {
  const std::vector<double> numbers = values_of(here_);
  slopes_.reserve(choice.size());
  for (std::size_t which = 0; which < choice.size(); ++which) {
    const auto slopes = slopes_along(scene, modes, numbers, t, forward, choice, which);
    corners_.push_back(!slopes);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    slopes_.push_back(slopes.value_or(std::vector(numbers.size(), none)));
  }
}

void MechanismAlong::refuse_corners() const {
  const auto found = std::ranges::find(corners_, true);
  if (found == corners_.end()) return;
  throw std::invalid_argument("parameter \"" + names_[found - corners_.begin()] +
                              "\": " + corner_of_a_law);
}

template <class Number>
Mechanism<Number> MechanismAlong::with_slopes(const std::vector<int>& parameters) const {
  auto result = alike<Number>(here_);
  const std::vector<Number*> duals = numbers_of(result);
  const std::vector<double> numbers = values_of(here_);
  for (std::size_t i = 0; i < duals.size(); ++i) {
    *duals[i] = Number(numbers[i]);
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      if (parameters[k] < 0) continue;
      set_lane(duals[i]->slope, static_cast<int>(k), slopes_[parameters[k]][i]);
    }
  }
  return result;
}

std::vector<Mechanism<AlongParameters>> MechanismAlong::with_all_slopes() const {
  std::vector<Mechanism<AlongParameters>> result;
  std::vector<int> some;
  for (std::size_t which = 0; which < slopes_.size(); ++which) {
    some.push_back(static_cast<int>(which));
    if (some.size() < parameters_at_once && which + 1 < slopes_.size()) continue;
    result.push_back(with_slopes<AlongParameters>(some));
    some.clear();
  }
  return result;
}

template Mechanism<AlongNames> MechanismAlong::with_slopes(const std::vector<int>&) const;

}  // namespace pendcore
