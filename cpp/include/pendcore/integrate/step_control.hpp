/// \file
/// The next step size from the error of this one: PI control.
///
///     h_next = h clamp(safety err^-(1/k - 3/4 beta) err_before^beta),  k = error_order + 1
///
/// After a rejection: h_next = h max(shrink, safety err^-(1/k - 3/4 beta)), and no growth straight
/// after it. Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), IV.2,
/// (2.43c), with the constants of their program DOPRI5. Errors come as logarithms in base 2.
#pragma once

#include <algorithm>
#include <cmath>

#include "pendcore/arithmetic/power.hpp"
#include "pendcore/integrate/tableau.hpp"

namespace pendcore {

struct StepControl {
  static constexpr double log2_smallest_error = -13.287712379549449;  // of 1e-4

  double log2_error_before = log2_smallest_error;
  bool after_rejection = false;

  /// The factor for the step after an accepted one.
  double accept(const MethodInfo& method, double log2_error) {
    const double log2_factor = method.beta * log2_error_before - exponent(method) * log2_error;
    const double largest = after_rejection ? 1.0 : method.growth;
    log2_error_before = std::max(log2_error, log2_smallest_error);
    after_rejection = false;
    return std::clamp(method.safety * approximate_exp2(log2_factor), method.shrink, largest);
  }

  /// The factor for the retry of a rejected step; the smallest where the error is not a number.
  double reject(const MethodInfo& method, double log2_error) {
    after_rejection = true;
    if (std::isnan(log2_error)) return method.shrink;
    const double log2_factor = -exponent(method) * log2_error;
    return std::max(method.safety * approximate_exp2(log2_factor), method.shrink);
  }

 private:
  static double exponent(const MethodInfo& method) {
    return 1.0 / (method.error_order + 1) - 0.75 * method.beta;
  }
};

}  // namespace pendcore
