/// \file
/// How the series of double_pendulum_series.hpp change along eight names at once.
///
/// They obey a linear recurrence (coefficients_of_changes.hpp): an order of all eight changes of
/// both links takes four fused operations for each order before it, where slopes of the recurrence
/// of the motion itself took sixteen.
///
/// Cost: for order p, 2 p^2 operations on packs for each eight names. Two orders at a time, and
/// sixteen names, share what is loaded for them.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "arithmetic/dual_rows.hpp"
#include "dynamics/mechanism.hpp"
#include "dynamics/series/coefficients_of_changes.hpp"
#include "dynamics/series/effects_with_slopes.hpp"

namespace pendcore {

/// Says whether a pivot has no acceleration itself. It may have slopes of a constant one.
inline bool stands_still(const PivotLawOf<AlongNames>& pivot) {
  const auto is_still = [](const PivotLawOf<AlongNames>::Axis& along) {
    return along.held.value == 0.0 && is_zero(along.slope) && is_zero(along.gain);
  };
  return is_still(pivot.x) && is_still(pivot.y);
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
    return !effects.any_held && effects.waves <= 2 &&
           std::ranges::all_of(effects.pivots, stands_still);
  }
  DoublePendulumAlongNames(const Mechanism<AlongNames>& of, Effects effects);

  /// Finds what all names have in common on a step from a state y.
  PENDCORE_INLINE void find_common(double t, const double* y, double sigma, int order,
                                   CoefficientsOfChanges& common) const;
  struct Changes;
  /// Computes the changes of `count` groups of eight names up to an even order.
  template <int count>
  PENDCORE_INLINE static void expand(const CoefficientsOfChanges& common, double sigma, int order,
                                     Changes* groups);

 private:
  Constants constants_;
  Links factor_;    ///< 1/A
  Links push_{};    ///< a/A by the acceleration of the pivot along x
  bool is_pushed_;  ///< whether some name has a share in it
  Effects effects_;
};

PENDCORE_INLINE void DoublePendulumAlongNames::find_common(double t, const double* y, double sigma,
                                                           int order,
                                                           CoefficientsOfChanges& common) const {
  const ConstantsOfDoublePendulum<double> constants{.weight = constants_.weight.value,
                                                    .coupling = constants_.coupling.value,
                                                    .rotor = constants_.rotor.value,
                                                    .product = constants_.product.value[0],
                                                    .delta = constants_.delta.value[0],
                                                    .epsilon = constants_.epsilon.value[0]};
  if (effects_.couples.empty() && effects_.waves == 0) {
    NoTorque none;
    return common.find(constants, y, sigma, order, none);
  }
  const TorqueLaws<Links, AlongNames> laws = torque_laws(effects_, factor_);
  Couples<Pair> couples;
  if (laws.couples != nullptr) {
    each_field(couples, *laws.couples, [](Pair& to, const Links& from) { to = from.value; });
    couples.has_powers = laws.couples->has_powers;
  }
  const TorqueLaws<Pair, double> values{.couples = laws.couples != nullptr ? &couples : nullptr,
                                        .waves = laws.waves,
                                        .angular_frequency = laws.angular_frequency.value,
                                        .phase = laws.phase.value,
                                        .gain = {laws.gain[0].value, laws.gain[1].value},
                                        .factor = laws.factor.value};
  TorqueOrders<Pair, double> torque(values, t, sigma);
  common.find(constants, y, sigma, order, torque);
}

/// The changes along eight names, while they are computed order by order.
struct DoublePendulumAlongNames::Changes {
  using Slopes = decltype(AlongNames::slope);
  /// The sums of both links. Each has two parts, so that one operation need not wait for the other.
  struct Sums {
    Slopes first, second, more_first, more_second;
  };

  PENDCORE_INLINE Changes(const DoublePendulumAlongNames& of, double t, double sigma,
                          AlongNames* to)
      : constants(of.constants_), push(of.is_pushed_ ? &of.push_ : nullptr), rows(to) {
    if (!of.effects_.couples.empty() || of.effects_.waves != 0) {
      laws = torque_laws(of.effects_, of.factor_);
      torque.emplace(laws, t, sigma);
    }
    for (int i = 0; i < 2; ++i) {
      angles[0][i] = rows[i].slope;
      angles[1][i] = sigma * rows[2 + i].slope;
    }
  }

  Changes(const Changes&) = delete;  // the torque refers to the laws

  /// Computes the terms of order k that the parameters and the torques give.
  PENDCORE_INLINE Sums given_terms(const CoefficientsOfChanges& common, int k) {
    const auto of_link = [&](int i, const Slopes& weight, const Slopes& coupling,
                             const Slopes& rotor) __attribute__((always_inline)) {
      return fma(common.cosine[i][k], weight,
                 fma(-common.bend[i][k], coupling, common.acceleration[1 - i][k] * rotor));
    };
    const Links &weight = constants.weight, &coupling = constants.coupling,
                &rotor = constants.rotor;
    Sums sums{of_link(0, weight.slope.first, coupling.slope.first, rotor.slope.first),
              of_link(1, weight.slope.second, coupling.slope.second, rotor.slope.second),
              {},
              {}};
    if (push != nullptr) {
      sums.first = fma(common.sine[0][k], push->slope.first, sums.first);
      sums.second = fma(common.sine[1][k], push->slope.second, sums.second);
    }
    if (torque) {
      const auto links = [&](const auto& series, int order, double by)
                             __attribute__((always_inline)) {
                               return Links{Pair{series[0][k], series[1][k]},
                                            {by * angles[order][0], by * angles[order][1]}};
                             };
      const Links given =
          torque->next(k, links(common.angle, k, 1.0), links(common.rate, k + 1, k + 1.0));
      sums.first = sums.first + given.slope.first;
      sums.second = sums.second + given.slope.second;
    }
    return sums;
  }

  TorqueLaws<Links, AlongNames> laws;
  std::optional<TorqueOrders<Links, AlongNames, Links>> torque;
  const Constants& constants;
  const Links* push;  ///< null if none
  AlongNames* rows;
  Slopes angles[highest_order + 3][2];
};

template <int count>
PENDCORE_INLINE void DoublePendulumAlongNames::expand(const CoefficientsOfChanges& common,
                                                      double sigma, int order, Changes* groups) {
  using Orders = CoefficientsOfChanges::Orders;
  using Slopes = Changes::Slopes;
  using Sums = Changes::Sums;
  using Factors = double[2][CoefficientsOfChanges::room];
  const Pair& kappa = common.kappa;
  const double per_sigma = inverse_of_power_of_two(sigma);
  const auto find_e = [&](int k, Factors& e) __attribute__((always_inline)) {
    for (int i = 0; i < 2; ++i) {
      const auto& [square, slope, constant] = common.of_angle[i];
      for (int m = 0; m < k + 2; m += CoefficientsOfChanges::width) {
        const Orders by_k = fma(static_cast<double>(k), load<Orders>(square.data() + m),
                                load<Orders>(slope.data() + m));
        store(e[i] + m, fma(static_cast<double>(k), by_k, load<Orders>(constant.data() + m)));
      }
    }
  };
  // Adds what order k has from the changes of order j.
  const auto add = [&](const Slopes* angles, const Factors& e, int k, int j, Sums& sums)
                       __attribute__((always_inline)) {
                         sums.first = fma(e[0][k - j + 1], angles[1], sums.first);
                         sums.second = fma(e[1][k - j + 1], angles[0], sums.second);
                         sums.more_first = fma(common.pull[0][k - j], angles[0], sums.more_first);
                         sums.more_second = fma(common.pull[1][k - j], angles[1], sums.more_second);
                       };
  const auto finish = [&](const Factors& e, int k, const Sums& sums,
                          Changes& changes) __attribute__((always_inline)) {
    auto& angles = changes.angles;
    const auto& [first, second, more_first, more_second] = sums;
    const double share = inverse_of[k + 1] * inverse_of[k + 2] * common.inverse;
    const Slopes of_first = fma(e[0][0], angles[k + 1][1], first + more_first);
    const Slopes of_second = fma(e[1][0], angles[k + 1][0], second + more_second);
    const Slopes next_first = share * fma(-kappa[0], of_second, of_first);
    const Slopes next_second = share * fma(-kappa[1], of_first, of_second);
    angles[k + 2][0] = next_first;
    angles[k + 2][1] = next_second;
    AlongNames* const row = changes.rows + 4 * (k + 1);
    row[0].slope = angles[k + 1][0];
    row[1].slope = angles[k + 1][1];
    row[2].slope = ((k + 2) * per_sigma) * next_first;
    row[3].slope = ((k + 2) * per_sigma) * next_second;
  };
  Factors e, next_e;  // from m = -1 on
  for (int k = 0; k < order; k += 2) {
    find_e(k, e);
    find_e(k + 1, next_e);
    Sums sums[count], next[count]{};
#pragma GCC unroll 2
    for (int p = 0; p < count; ++p) sums[p] = groups[p].given_terms(common, k);
    for (int j = 0; j <= k; ++j) {
#pragma GCC unroll 2
      for (int p = 0; p < count; ++p) {
        add(groups[p].angles[j], e, k, j, sums[p]);
        add(groups[p].angles[j], next_e, k + 1, j, next[p]);
      }
    }
#pragma GCC unroll 2
    for (int p = 0; p < count; ++p) {
      finish(e, k, sums[p], groups[p]);
      const Sums given = groups[p].given_terms(common, k + 1);
      add(groups[p].angles[k + 1], next_e, k + 1, k + 1, next[p]);
      next[p].first = next[p].first + given.first;
      next[p].second = next[p].second + given.second;
      finish(next_e, k + 1, next[p], groups[p]);
    }
  }
}

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
  const Links arms = pair_of(a1, a2) * factor_;
  Number push_x{}, gravity = of.gravity;  // less the acceleration of the pivot along y
  for (const PivotLawOf<Number>& pivot : effects_.pivots) {
    push_x = push_x + pivot.x.held;
    gravity = gravity - pivot.y.held;
  }
  is_pushed_ = !is_zero(push_x);
  push_ = links(push_x) * arms;
  constants_ = {.weight = links(gravity) * arms,
                .coupling = links(A12) * factor_,
                .rotor = links(J) * factor_,
                .product = links(A12 * A12) * both,
                .delta = links(determinant + J * (A1 + A2)) * both,
                .epsilon = links(2.0 * (A12 * J)) * both};
}

}  // namespace pendcore
