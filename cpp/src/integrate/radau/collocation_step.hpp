/// \file
/// One step of a collocation method (collocation.hpp) applied to q'' = a(t, q, q').
///
/// The stages Z = T W solve Z = h a F(Z); simplified Newton with the Jacobian J at the start of the
/// step splits into a real and a complex system,
///
///     (g - J) dW_1 = T^-1 F - g W_1,   g = real/h;    (g - J)(dW_2 + i dW_3) alike, g = (alpha +
///     i beta)/h
///
/// They are solved as systems of half the size (newton_systems.hpp).
///
/// The error is (g - J)^-1 (f(t, y) - u'(t)), g = real/h, with u the polynomial of the step. It is
/// of order 3, and damped where J is. The tolerances are for the error of the step itself, which is
/// of order 5. Therefore the estimate is compared with 0.1 rtol^(2/3), and with atol in proportion.
///
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.8: the
/// iteration and where it stops, error (8.20), starting values (8.5), predictive control (8.25).
/// Unlike in their program, J and its factors are made for every step. This is exact and cheap
/// here, and a step depends only on its start and on what saved_state() has of the step before.
/// Cost: three right-hand sides for each of two to four iterations, and one J.
#pragma once

#include <algorithm>
#include <cmath>

#include "arithmetic/epsilon.hpp"
#include "arithmetic/pack.hpp"
#include "arithmetic/power.hpp"
#include "arithmetic/two_double.hpp"
#include "integrate/general_system.hpp"
#include "integrate/radau/collocation.hpp"
#include "integrate/radau/newton_systems.hpp"
#include "integrate/stepper.hpp"

namespace pendcore {

/// x^p for x > 0, the same on every machine.
PENDCORE_INLINE double small_power(double x, double p) {
  return approximate_exp2(p * approximate_log2(x));
}

/// The step of so many links, or of any number (Eigen::Dynamic), then also with quadratures. If the
/// compiler knows the number, all angles and rates are one pack, and the kernel has its state in
/// registers: a step of two links takes a quarter of the time of one of three.
template <int links>
struct CollocationStep {
  static constexpr bool is_fixed = links != Eigen::Dynamic;
  static constexpr int numbers = is_fixed ? 2 * links : Eigen::Dynamic;
  using Block = BlockOfState<links>;
  static constexpr int width = Lanes<Block>::width;
  using Row = Eigen::Matrix<double, numbers, 1>;
  using Rows = Eigen::Matrix<double, 3, numbers, Eigen::RowMajor>;

  static constexpr int most_iterations = 20;  // a fixed step may be long
  static constexpr int usual_iterations = 7;  // more than these make the next step shorter

  const Collocation& method;
  const DifferentiableSystem& system;
  Stepper& counts;  ///< what has been computed so far is counted there
  int angles;       ///< numbers in q
  bool compensated;

  double newton_tolerance = 0.0;
  Row rtol, atol, y, dydt, y_new;
  Rows stages, transformed, rates, increment;
  Rows trial;  ///< states for which rates are wanted: mostly those of the stages
  Row error;
  Row slope;         ///< h u'(t) of the dense output
  Row scale;         ///< what the tolerances allow at y and y_new
  Row low, low_new;  ///< the rounding errors of y and y_new, if compensated
  NewtonSystems<links> systems;
  bool has_jacobian = false;
  int iterations = 0;  ///< iterations of the last attempt
  double h_tried = 0.0;
  double squared_error = 0.0;
  double contraction_of_attempt = 1.0;

  // What the next step takes from the step before; h_before is 0 if there is none.
  Rows polynomial;  ///< powers 1 to 3
  double h_before = 0.0;
  double log2_error_before = 0.0;
  double contraction = 1.0;
  bool is_retry = false;

  CollocationStep(const Collocation& one, const DifferentiableSystem& rates_of,
                  bool carries_rounding, Stepper& stepper)
      : method(one),
        system(rates_of),
        counts(stepper),
        angles(rates_of.row),
        compensated(carries_rounding),
        systems(rates_of.row) {
    const int count = 2 * rates_of.row + rates_of.quadratures;
    for (auto* row : {&rtol, &atol, &y, &dydt, &y_new, &error, &slope, &scale, &low, &low_new}) {
      row->setZero(count);
    }
    for (auto* rows : {&stages, &transformed, &rates, &increment, &trial, &polynomial}) {
      rows->setZero(3, count);
    }
  }

  /// The numbers in q, in q and qd, and in these and the quadratures. Hot loops keep them in a
  /// variable: for all the compiler knows, the store of a pack may change any member.
  PENDCORE_INLINE int n() const { return is_fixed ? links : angles; }
  PENDCORE_INLINE int state() const { return 2 * n(); }
  PENDCORE_INLINE int size() const { return static_cast<int>(y.size()); }

  PENDCORE_INLINE Block at(const Row& row, int i) const { return load<Block>(&row[i]); }
  PENDCORE_INLINE Block at(const Rows& rows, int k, int i) const {
    return load<Block>(&rows(k, i));
  }
  /// A row of the matrix times three numbers.
  template <class Number>
  PENDCORE_INLINE static Number product(const Collocation::Row& row, const Number& x,
                                        const Number& y, const Number& z) {
    return row[0] * x + row[1] * y + row[2] * z;
  }
  /// The same times the three rows at i.
  template <class Number = Block>
  PENDCORE_INLINE static Number product(const Collocation::Row& row, const Rows& of, int i) {
    return product(row, load<Number>(&of(0, i)), load<Number>(&of(1, i)), load<Number>(&of(2, i)));
  }
  /// The coefficient of theta^(p + 1) of u, through the stages.
  template <class Number = Block>
  PENDCORE_INLINE Number power_of_stages(int p, int i) const {
    return product<Number>(method.interpolant[p], stages, i);
  }
  PENDCORE_INLINE void evaluate(double t, const double* state, double* rate) {
    system(t, state, rate);
    ++counts.evaluations;
  }

  /// |x|. absolute() goes number by number where the compiler does not vectorise (CMakeLists.txt),
  /// which would cost a twentieth of a step of two links.
  PENDCORE_INLINE static Block size_of(const Block& x) { return larger(x, Block(-x)); }
  PENDCORE_INLINE void set_scale() {
    const int count = state();
    for (int i = 0; i < count; i += width) {
      const Block largest = larger(size_of(at(y_new, i)), size_of(at(y, i)));
      // 1e-300 avoids 0/0.
      store(&scale[i], at(atol, i) + at(rtol, i) * largest + 1e-300);
    }
  }
  PENDCORE_INLINE double squared_norm(const double* row) const {
    const int count = state();
    double sum = 0.0;
    for (int i = 0; i < count; i += width) {
      const Block ratio = load<Block>(row + i) / at(scale, i);
      const Block square = ratio * ratio;
      for (int k = 0; k < width; ++k) sum += lane(square, k);
    }
    return sum / count;
  }

  /// Predicts the stages by continuing the polynomial of the step before: Z_i = u(1 + x) - u(1), x
  /// = c_i h/h_before.
  PENDCORE_INLINE void predict(double h) {
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      const double x = h_before == 0.0 ? 0.0 : method.c[k] * (h / h_before);
      const Collocation::Row powers = {x, x * (2.0 + x), x * (3.0 + x * (3.0 + x))};
      for (int i = 0; i < state(); i += width) {
        store(&stages(k, i), h_before == 0.0 ? Block{} : product(powers, polynomial, i));
      }
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < state(); i += width) {
        store(&transformed(k, i), product(method.inverse[k], stages, i));
      }
    }
  }

  /// Whether the last increment is no larger than the rounding errors of rates and states.
  bool is_rounding(double h) const {
    for (int i = 0; i < state(); ++i) {
      double largest = std::abs(y[i]) + std::abs(y_new[i]);
      double change = 0.0;
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        largest += std::abs(h * rates(k, i));
        change = std::max(change, std::abs(increment(k, i)));
      }
      if (!(change <= 16.0 * epsilon * largest)) return false;
    }
    return true;
  }

  /// Evaluates the right-hand side at the three stages.
  PENDCORE_INLINE void evaluate_stages(double t, double h) {
    const int count = state();
    double times[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      times[k] = t + method.c[k] * h;
      for (int i = 0; i < count; i += width) {
        store(&trial(k, i), at(y, i) + at(stages, k, i));
      }
    }
    system.derivatives_of_three(times, trial.data(), rates.data());
    counts.evaluations += 3;
  }

  /// Improves the stages by one iteration of Newton's, and returns the size of the improvement.
  PENDCORE_INLINE double improve() {
    const int count = state();
    const double re = systems.complex.g.real();
    const double im = systems.complex.g.imag();
    for (int i = 0; i < count; i += width) {
      Block rate[3];
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) rate[k] = product(method.inverse[k], rates, i);
      const Block w_re = at(transformed, 1, i);
      const Block w_im = at(transformed, 2, i);
      store(&increment(0, i), rate[0] - systems.real.g * at(transformed, 0, i));
      store(&increment(1, i), rate[1] - (re * w_re - im * w_im));
      store(&increment(2, i), rate[2] - (im * w_re + re * w_im));
    }
    systems.solve_real(&increment(0, 0));
    systems.solve_complex(&increment(1, 0), &increment(2, 0));
    for (int i = 0; i < count; i += width) {
      Block moved[3];
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        moved[k] = at(transformed, k, i) + at(increment, k, i);
        store(&transformed(k, i), moved[k]);
      }
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        const Block stage = product(method.transformation[k], moved[0], moved[1], moved[2]);
        store(&stages(k, i), stage);
        if (k == 2) store(&y_new[i], at(y, i) + stage);
      }
    }
    set_scale();
    return std::sqrt((squared_norm(&increment(0, 0)) + squared_norm(&increment(1, 0)) +
                      squared_norm(&increment(2, 0))) /
                     3.0);
  }

  /// Solves for the stages by Newton's iteration. Returns false if it does not converge.
  PENDCORE_INLINE bool iterate(double t, double h) {
    double factor = small_power(std::max(contraction, epsilon), 0.8);  // theta/(1 - theta)
    contraction_of_attempt = contraction;
    double before = 0.0;
    double ratio_before = 0.0;
#pragma GCC unroll 1
    for (iterations = 1; iterations <= most_iterations; ++iterations) {
      evaluate_stages(t, h);
      const double change = improve();
      if (!std::isfinite(change)) return false;
      double theta = 0.0;
      if (iterations > 1) {
        const double ratio = change / before;
        theta = iterations == 2 ? ratio : std::sqrt(ratio * ratio_before);
        ratio_before = ratio;
        if (!(theta < 0.99)) return change <= newton_tolerance || is_rounding(h);
        factor = theta / (1.0 - theta);
      }
      if (factor * change <= newton_tolerance) {
        contraction_of_attempt = factor;
        return true;
      }
      if (iterations > 1) {
        double left = factor * change;
        for (int k = iterations; k < most_iterations; ++k) left *= theta;
        if (left > newton_tolerance) return is_rounding(h);
      }
      before = std::max(change, epsilon);
    }
    return false;
  }

  /// Computes Z = h a q' for the angles from the rates that were found, which restores digits that
  /// the transformation T costs. A rate that nothing changes, as in a held joint, keeps its last
  /// bit.
  PENDCORE_INLINE void polish(double h) {
    for (int i = n(); i < state(); ++i) {
      if (rates(0, i) != 0.0 || rates(1, i) != 0.0 || rates(2, i) != 0.0) continue;
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) stages(k, i) = 0.0;
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      const auto angle = [&](Eigen::Index i) {
        const int rate = n() + static_cast<int>(i);
        return h * (method.c[k] * y[rate] + product<double>(method.a[k], stages, rate));
      };
      store_state<links>(&stages(k, 0), n(),
                         Eigen::Matrix<double, links, 1>::NullaryExpr(n(), angle),
                         stages.row(k).segment(n(), n()));
    }
  }

  /// Computes y + Z_3, with the rounding error if the method is compensated.
  PENDCORE_INLINE void advance() {
    if (!compensated) {
      for (int i = 0; i < size(); i += width) store(&y_new[i], at(y, i) + at(stages, 2, i));
      return;
    }
    for (int i = 0; i < size(); ++i) {
      const double whole = stages(2, i) + low[i];
      y_new[i] = y[i] + whole;
      low_new[i] = left_over(y[i], whole, y_new[i]);
    }
  }

  /// Computes Z = h a P for the quadratures from their rates P at the stages that were found.
  /// Quadratures take no part in the iteration and in the error.
  PENDCORE_INLINE void integrate_quadratures(double t, double h) {
    evaluate_stages(t, h);
    for (int i = state(); i < size(); ++i) {
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) stages(k, i) = h * product<double>(method.a[k], rates, i);
    }
  }

  /// The square of the error that a rate at the start of the step shows.
  PENDCORE_INLINE double filtered(const double* rate, double h) {
    for (int i = 0; i < state(); i += width) {
      store(&error[i], load<Block>(rate + i) - power_of_stages(0, i) / h);
    }
    systems.solve_real(error.data());
    return squared_norm(error.data());
  }

  /// Sets h times the slope of the polynomial at its start. This is h f(t, y), so that sol(t) has
  /// no corners, unless it differs from the slope of the stages by more than the error allows.
  /// Otherwise a stiff component that has died out would turn the last bits of its state into a
  /// slope that the motion does not have anywhere in the step.
  PENDCORE_INLINE void set_slope(double h) {
    bool all_are_exact = true;
    for (int i = 0; i < size(); ++i) {
      const double of_stages = power_of_stages<double>(0, i);
      const double exact = h * dydt[i];
      double of_error = 0.0;
      bool is_exact = all_are_exact;
      if (i < state()) {
        of_error = method.real * error[i];
        is_exact = std::abs(exact - of_stages) <= std::max(2.0 * std::abs(of_error), scale[i]);
        all_are_exact = all_are_exact && is_exact;
      }
      slope[i] = is_exact ? exact : of_stages + of_error;
    }
  }
};

}  // namespace pendcore
