/// \file
/// Angles and rates as functions of events: differences of two numbers of the state, and the levels
/// that they pass.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/pack.hpp"
#include "pendcore/events.hpp"

namespace pendcore {

/// An angle or a rate: y[plus] - y[minus], or y[plus] alone if `minus` is negative. The event is
/// where it is `value`, or where it is `value` plus any number of turns.
struct Difference {
  int plus;
  int minus;
  double value = 0.0;
  bool every_turn = false;

  double of(const double* y) const { return minus < 0 ? y[plus] : y[plus] - y[minus]; }
  /// The sizes of what is subtracted.
  double size(const double* y) const {
    return std::abs(y[plus]) + (minus < 0 ? 0.0 : std::abs(y[minus]));
  }
  /// The difference minus a level; 0 within the rounding of the state.
  double from(double level, const double* y) const {
    const double x = of(y) - level;
    return std::abs(x) <= last_bits_share * (size(y) + std::abs(level)) ? 0.0 : x;
  }
};

/// The difference whose levels are the events of a function, in a chain of n links; none where it
/// is of another kind.
std::optional<Difference> difference_of(const EventFunction& function, int n);

/// value + (first + i) 2 pi for i = 0 ... count - 1
struct Levels {
  static constexpr double turn = 6.283185307179586;
  double value, first, count;
  double at(int i) const { return fma(first + i, turn, value); }
};

/// The levels of a difference between two of its values, or a rounding beyond them.
Levels levels_between(const Difference& difference, double low, double high);
/// The levels that a difference may pass where it is a polynomial in theta, within the bounds of
/// its Bernstein form, and is `end` at 1.
Levels levels_along(const Difference& difference, const std::vector<double>& polynomial, double end,
                    double noise);

}  // namespace pendcore
