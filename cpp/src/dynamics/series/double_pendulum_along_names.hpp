/// \file
/// The series of double_pendulum_series.hpp with slopes along eight names at once.
///
/// Values of both links are in one pack, slopes of each number in another one. What takes the time
/// are the sums: two fused operations for each product and eight slopes. A value is read from
/// memory into all places of a pack on the way to an operation; out of a register it would take an
/// operation of its own.
#pragma once

#include <utility>

#include "arithmetic/dual_rows.hpp"
#include "dynamics/mechanism.hpp"
#include "dynamics/series/double_pendulum_series.hpp"
#include "dynamics/series/effects_with_slopes.hpp"

namespace pendcore {

template <>
struct SeriesOf<AlongNames> {
  using Slopes = decltype(AlongNames::slope);
  using Half = PairOf<AlongNames>;
  using Row = Dual<Pairs, TwoPairs<Slopes>>;
  using Rate = Half;
  PENDCORE_INLINE static Rate rate(const Half& x) { return x; }
  PENDCORE_INLINE static Half pair(const Rate& x) { return x; }
  PENDCORE_INLINE static Half pair_at(const AlongNames* from) { return pair_of(from[0], from[1]); }
  PENDCORE_INLINE static void put_row(AlongNames* to, const Row& row) {
    to[0] = {row.value[0], row.slope.first.first};
    to[1] = {row.value[1], row.slope.first.second};
    to[2] = {row.value[2], row.slope.second.first};
    to[3] = {row.value[3], row.slope.second.second};
  }
};
template <>
inline constexpr bool has_long_orders<AlongNames> = true;

/// A row or a rate in memory, whose products are added to a sum.
struct RowInMemory {
  const SeriesOf<AlongNames>::Row* at;

  PENDCORE_INLINE const Pairs& values() const { return at->value; }
  PENDCORE_INLINE double value(int i) const { return number(&at->value, i); }
  PENDCORE_INLINE const auto& slopes(int i) const {
    const auto& half = i < 2 ? at->slope.first : at->slope.second;
    return i % 2 == 0 ? half.first : half.second;
  }
  template <class Values>
  PENDCORE_INLINE static double number(const Values* values, int i) {
    return reinterpret_cast<const double*>(values)[i];  // NOLINT(*-reinterpret-cast): see above
  }
};
struct RateInMemory {
  const SeriesOf<AlongNames>::Rate* at;

  PENDCORE_INLINE Pairs values() const { return twice(at->value); }
  PENDCORE_INLINE double value(int i) const { return RowInMemory::number(&at->value, i % 2); }
  PENDCORE_INLINE const auto& slopes(int i) const {
    return i % 2 == 0 ? at->slope.first : at->slope.second;
  }
};
template <class Factor>
PENDCORE_INLINE SeriesOf<AlongNames>::Row fma(const Factor& a, const RowInMemory& b,
                                              const SeriesOf<AlongNames>::Row& c) {
  const auto slopes = [&](int i, const auto& sum) __attribute__((always_inline)) {
    return fma(a.value(i), b.slopes(i), fma(b.value(i), a.slopes(i), sum));
  };
  const auto& [low, high] = c.slope;
  return {fma(Pairs(a.values()), b.values(), c.value),
          {{slopes(0, low.first), slopes(1, low.second)},
           {slopes(2, high.first), slopes(3, high.second)}}};
}
template <class Add>
PENDCORE_INLINE auto sums_of(const DoublePendulumOrders<AlongNames>& orders, const Add& add) {
  return add.template operator()<SeriesOf<AlongNames>::Row>(
      [&](std::ptrdiff_t j)
          __attribute__((always_inline)) { return RowInMemory{&orders.pulls[j]}; },
      [&](std::ptrdiff_t j)
          __attribute__((always_inline)) { return RateInMemory{&orders.rates[j]}; },
      [&](std::ptrdiff_t j) __attribute__((always_inline)) { return RowInMemory{&orders.n[j]}; });
}

/// Two links that turn freely, whose pivot stands still and which at most two waves drive.
class DoublePendulumAlongNames {
  using Links = PairOf<AlongNames>;
  struct Constants {  ///< as ConstantsOfDoublePendulum, but a pair each
    Links weight, coupling, rotor, product, delta, epsilon;
  };

 public:
  using Effects = EffectsWithSlopes<Links>;

  static bool has(const Effects& effects) {
    return !effects.any_held && effects.pivots.empty() && effects.waves <= 2;
  }
  DoublePendulumAlongNames(const Mechanism<AlongNames>& of, Effects effects);

  void set_order(int /*order*/) {}
  PENDCORE_INLINE void expand(double t, const AlongNames* y, double sigma, int order,
                              AlongNames* rows) const {
    const TorqueLaws<Links, AlongNames> laws = torque_laws(effects_, factor_);
    TorqueOrders<Links, AlongNames, Links> torque(laws, t, sigma);
    expand_double_pendulum(constants_, y, sigma, order, torque, rows);
  }

 private:
  Constants constants_;
  Links factor_;  ///< 1/A
  Effects effects_;
};

/// The constants are those of the closed forms (double_pendulum_with_effects.cpp).
inline DoublePendulumAlongNames::DoublePendulumAlongNames(const Mechanism<AlongNames>& of,
                                                          Effects effects)
    : effects_(std::move(effects)) {
  using Number = AlongNames;
  const auto& first = of.bodies[0];
  const auto& second = of.bodies[1];
  const Number J = second.armature;
  const Number hung = second.mass + of.payload_mass;
  const Number square = first.length * first.length;
  const Number about_joint =
      first.inertia + first.mass * first.center * first.center + first.armature;
  const Number about_center = second.inertia + of.payload_inertia;
  const Number A1 = about_joint + square * hung;  // without J
  const Number A2 = about_center + second.mass * second.center * second.center +
                    of.payload_mass * second.length * second.length;
  const Number apart = second.length - second.center;
  const Number determinant =
      about_joint * A2 +
      square * (hung * about_center + second.mass * of.payload_mass * apart * apart);
  const Number a1 = first.mass * first.center + first.length * hung;
  const Number a2 = second.mass * second.center + second.length * of.payload_mass;
  const Number A12 = first.length * a2;
  factor_ = pair_of(1.0 / (A1 + J), 1.0 / (A2 + J));
  const Links both = factor_ * other(factor_);
  const auto links = [](const Number& x) { return pair_of(x, x); };
  constants_ = {.weight = links(of.gravity) * (pair_of(a1, a2) * factor_),
                .coupling = links(A12) * factor_,
                .rotor = links(J) * factor_,
                .product = links(A12 * A12) * both,
                .delta = links(determinant + J * (A1 + A2)) * both,
                .epsilon = links(2.0 * (A12 * J)) * both};
}

}  // namespace pendcore
