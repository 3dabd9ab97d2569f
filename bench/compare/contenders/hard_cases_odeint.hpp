// Declarations that the files of hard_cases_odeint share.
#pragma once

#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "conversation.hpp"

namespace hard_cases {

using Numbers = std::vector<double>;

// The answer to a request: names with their numbers, in front of a semicolon each.
inline std::string told;
inline void tell(const std::string& name, const Numbers& numbers) {
  told += name + contenders::words(numbers) + ';';
}

template <class State>
auto controlled_dopri5(double atol, double rtol) {
  return boost::numeric::odeint::make_controlled(
      atol, rtol, boost::numeric::odeint::runge_kutta_dopri5<State>());
}

// The rates of two rods of 1 kg and 1 m, with couples at the joints.
template <class State>
void textbook(const State& y, State& f, double first = 0, double second = 0) {
  constexpr double g = 9.807;
  const double d = y[0] - y[1], a12 = 0.5 * std::cos(d), h = 0.5 * std::sin(d);
  const double r1 = 1.5 * g * std::cos(y[0]) - h * y[3] * y[3] + first - second;
  const double r2 = 0.5 * g * std::cos(y[1]) + h * y[2] * y[2] + second;
  const double determinant = 4.0 / 9 - a12 * a12;
  f[0] = y[2];
  f[1] = y[3];
  f[2] = (r1 / 3 - a12 * r2) / determinant;
  f[3] = (4.0 / 3 * r2 - a12 * r1) / determinant;
}

// Cases in hard_cases_odeint_swings.cpp.
void payload(const Numbers& numbers);
void chain(const Numbers& numbers);
void drift(const Numbers& numbers);
void shaken(const Numbers& numbers);

}  // namespace hard_cases
