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
#include "arithmetic/power.hpp"
#include "arithmetic/two_double.hpp"
#include "integrate/general_system.hpp"
#include "integrate/radau/newton_systems.hpp"
#include "integrate/stepper.hpp"

namespace pendcore {

/// x^p for x > 0, the same on every machine.
PENDCORE_INLINE double small_power(double x, double p) {
  return approximate_exp2(p * approximate_log2(x));
}

template <class Sizes>
struct CollocationStep {
  using Block = typename Sizes::Block;
  static constexpr int width = Lanes<Block>::width;
  template <int rows>
  using Rows = typename Sizes::template Rows<rows>;

  static constexpr int most_iterations = 20;  // a fixed step may be long
  static constexpr int usual_iterations = 7;  // more than these make the next step shorter

  const Collocation& method;
  const DifferentiableSystem& system;
  Sizes sizes;
  bool compensated;
  Stepper& counts;  ///< what has been computed so far is counted there

  double newton_tolerance = 0.0;
  Rows<1> rtol, atol, y, dydt, y_new;
  Rows<3> stages, transformed, rates, increment;
  Rows<3> trial;  ///< states for which rates are wanted: mostly those of the stages
  Rows<1> error;
  Rows<1> slope;  ///< h u'(t) of the dense output
  Rows<1> scale;  ///< what the tolerances allow at y and y_new
  NewtonSystems<Sizes> systems;
  bool has_jacobian = false;
  int iterations = 0;  ///< iterations of the last attempt
  double h_tried = 0.0;
  double squared_error = 0.0;
  double contraction_of_attempt = 1.0;
  Rows<1> low, low_new;  ///< the rounding errors of y and y_new, if compensated

  // What the next step takes from the step before; h_before is 0 if there is none.
  Rows<3> polynomial;  ///< powers 1 to 3
  double h_before = 0.0;
  double log2_error_before = 0.0;
  double contraction = 1.0;
  bool is_retry = false;

  CollocationStep(const Collocation& one, const DifferentiableSystem& rates_of, const Sizes& given,
                  bool carries_rounding, Stepper& stepper)
      : method(one),
        system(rates_of),
        sizes(given),
        compensated(carries_rounding),
        counts(stepper) {
    for (auto* row : {&rtol, &atol, &y, &dydt, &y_new, &error, &slope, &scale}) {
      Sizes::allocate(*row, sizes.size);
    }
    for (auto* rows : {&stages, &transformed, &rates, &increment, &trial, &polynomial}) {
      Sizes::allocate(*rows, 3 * sizes.size);
    }
    for (auto* row : {&low, &low_new}) Sizes::allocate(*row, compensated ? sizes.size : 0);
  }

  PENDCORE_INLINE Block at(const double* row, int i) const { return load<Block>(row + i); }
  /// A row of the matrix times three numbers.
  template <class Number>
  PENDCORE_INLINE static Number product(const Collocation::Row& row, const Number& x,
                                        const Number& y, const Number& z) {
    return row[0] * x + row[1] * y + row[2] * z;
  }
  /// The coefficient of theta^(p + 1) of u, through the stages.
  template <class Number>
  PENDCORE_INLINE Number power_of_stages(int p, int i) const {
    const double* const z = stages.data() + i;
    return product(method.interpolant[p], load<Number>(z), load<Number>(z + sizes.size),
                   load<Number>(z + 2 * sizes.size));
  }

  PENDCORE_INLINE void evaluate(double t, const double* state, double* rate) {
    system(t, state, rate);
    ++counts.evaluations;
  }

  PENDCORE_INLINE void set_scale() {
    for (int i = 0; i < sizes.state; i += width) {
      const Block largest = larger(absolute(at(y_new.data(), i)), absolute(at(y.data(), i)));
      // 1e-300 avoids 0/0.
      store(&scale[i], at(atol.data(), i) + at(rtol.data(), i) * largest + 1e-300);
    }
  }
  PENDCORE_INLINE double squared_norm(const double* row) const {
    double sum = 0.0;
    for (int i = 0; i < sizes.state; i += width) {
      const Block ratio = at(row, i) / at(scale.data(), i);
      const Block square = ratio * ratio;
      for (int k = 0; k < width; ++k) sum += lane(square, k);
    }
    return sum / sizes.state;
  }

  /// Predicts the stages by continuing the polynomial of the step before: Z_i = u(1 + x) - u(1), x
  /// = c_i h/h_before.
  PENDCORE_INLINE void predict(double h) {
    const int size = sizes.size;
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      const double x = h_before == 0.0 ? 0.0 : method.c[k] * (h / h_before);
      const double square = x * (2.0 + x);
      const double cube = x * (3.0 + x * (3.0 + x));
      for (int i = 0; i < sizes.state; i += width) {
        const double* const p = polynomial.data() + i;
        const Block predicted = x * at(p, 0) + square * at(p, size) + cube * at(p, 2 * size);
        store(&stages[k * size + i], h_before == 0.0 ? Block{} : predicted);
      }
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < sizes.state; i += width) {
        const double* const z = stages.data() + i;
        store(&transformed[k * size + i],
              product(method.inverse[k], at(z, 0), at(z, size), at(z, 2 * size)));
      }
    }
  }

  /// Whether the last increment is no larger than the rounding errors of rates and states.
  bool is_rounding(double h) const {
    for (int i = 0; i < sizes.state; ++i) {
      double largest = std::abs(y[i]) + std::abs(y_new[i]);
      double change = 0.0;
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        largest += std::abs(h * rates[k * sizes.size + i]);
        change = std::max(change, std::abs(increment[k * sizes.size + i]));
      }
      if (!(change <= 16.0 * epsilon * largest)) return false;
    }
    return true;
  }

  /// Evaluates the right-hand side at the three stages.
  PENDCORE_INLINE void evaluate_stages(double t, double h) {
    const int size = sizes.size;
    double times[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      times[k] = t + method.c[k] * h;
      for (int i = 0; i < sizes.state; i += width) {
        store(&trial[k * size + i], at(y.data(), i) + at(&stages[k * size], i));
      }
    }
    system.derivatives_of_three(times, trial.data(), rates.data());
    counts.evaluations += 3;
  }

  /// Improves the stages by one iteration of Newton's, and returns the size of the improvement.
  PENDCORE_INLINE double improve() {
    const int size = sizes.size;
    double* const w = transformed.data();
    double* const d = increment.data();
    const double real = systems.real_g;
    const Complex g = systems.complex_g;
    for (int i = 0; i < sizes.state; i += width) {
      const double* const f = rates.data() + i;
      Block rate[3];
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        rate[k] = product(method.inverse[k], at(f, 0), at(f, size), at(f, 2 * size));
      }
      const Block re = at(w, size + i);
      const Block im = at(w, 2 * size + i);
      store(d + i, rate[0] - real * at(w, i));
      store(d + size + i, rate[1] - (g.re * re - g.im * im));
      store(d + 2 * size + i, rate[2] - (g.im * re + g.re * im));
    }
    systems.solve_real(sizes.n, d);
    systems.solve_complex(sizes.n, d + size, d + 2 * size);
    for (int i = 0; i < sizes.state; i += width) {
      Block moved[3];
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        moved[k] = at(w, k * size + i) + at(d, k * size + i);
        store(w + k * size + i, moved[k]);
      }
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        const Block stage = product(method.transformation[k], moved[0], moved[1], moved[2]);
        store(&stages[k * size + i], stage);
        if (k == 2) store(&y_new[i], at(y.data(), i) + stage);
      }
    }
    set_scale();
    return std::sqrt((squared_norm(d) + squared_norm(d + size) + squared_norm(d + 2 * size)) / 3.0);
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
    const int n = sizes.n;
    const int size = sizes.size;
    for (int i = n; i < sizes.state; ++i) {
      if (rates[i] != 0.0 || rates[size + i] != 0.0 || rates[2 * size + i] != 0.0) continue;
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) stages[k * size + i] = 0.0;
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
      const auto angle = [&](int i) __attribute__((always_inline)) {
        const double* const rate = &stages[n + i];
        return h *
               (method.c[k] * y[n + i] + product(method.a[k], rate[0], rate[size], rate[2 * size]));
      };
      const auto rate = [&](int i)
                            __attribute__((always_inline)) { return stages[k * size + n + i]; };
      Sizes::store_state(&stages[k * size], n, angle, rate);
    }
  }

  /// Computes y + Z_3, with the rounding error if the method is compensated.
  PENDCORE_INLINE void advance() {
    const double* const change = &stages[2 * sizes.size];
    if (!compensated) {
      for (int i = 0; i < sizes.size; i += width) {
        store(&y_new[i], at(y.data(), i) + at(change, i));
      }
      return;
    }
    for (int i = 0; i < sizes.size; ++i) {
      const double whole = change[i] + low[i];
      y_new[i] = y[i] + whole;
      low_new[i] = left_over(y[i], whole, y_new[i]);
    }
  }

  /// Computes Z = h a P for the quadratures from their rates P at the stages that were found.
  /// Quadratures take no part in the iteration and in the error.
  PENDCORE_INLINE void integrate_quadratures(double t, double h) {
    const int size = sizes.size;
    evaluate_stages(t, h);
    for (int i = sizes.state; i < size; ++i) {
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        stages[k * size + i] =
            h * product(method.a[k], rates[i], rates[size + i], rates[2 * size + i]);
      }
    }
  }

  /// The square of the error that a rate at the start of the step shows.
  PENDCORE_INLINE double filtered(const double* rate, double h) {
    for (int i = 0; i < sizes.state; i += width) {
      store(&error[i], at(rate, i) - power_of_stages<Block>(0, i) / h);
    }
    systems.solve_real(sizes.n, error.data());
    return squared_norm(error.data());
  }

  /// Sets h times the slope of the polynomial at its start. This is h f(t, y), so that sol(t) has
  /// no corners, unless it differs from the slope of the stages by more than the error allows.
  /// Otherwise a stiff component that has died out would turn the last bits of its state into a
  /// slope that the motion does not have anywhere in the step.
  PENDCORE_INLINE void set_slope(double h) {
    bool all_are_exact = true;
    for (int i = 0; i < sizes.size; ++i) {
      const double of_stages = power_of_stages<double>(0, i);
      const double exact = h * dydt[i];
      double of_error = 0.0;
      bool is_exact = all_are_exact;
      if (i < sizes.state) {
        of_error = method.real * error[i];
        is_exact = std::abs(exact - of_stages) <= std::max(2.0 * std::abs(of_error), scale[i]);
        all_are_exact = all_are_exact && is_exact;
      }
      slope[i] = is_exact ? exact : of_stages + of_error;
    }
  }

  PENDCORE_INLINE void write_polynomial(double* rows) const {
#pragma GCC unroll 3
    for (int p = 0; p < 3; ++p) {
      for (int i = 0; i < sizes.size; i += width) {
        store(rows + p * sizes.size + i, power_of_stages<Block>(p, i));
      }
    }
  }
};

}  // namespace pendcore
