/// \file
/// The next step size from the error of this one: PI control.
///
///     h_next = h clamp(safety err^-(1/k - 3/4 beta) err_before^beta),  k = error_order + 1
///
/// After a rejection h_next = h max(shrink, safety err^-(1/k - 3/4 beta)), and the step after it
/// does not grow. Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996),
/// IV.2, (2.43c), with the constants of their program DOPRI5.
///
/// At the start of a step everything but err is known: 2^gain = safety err_before^beta. The kernel
/// of the step returns 2^gain err^-exponent together with the error, because the next step waits
/// for it.
#pragma once

#include <algorithm>
#include <cmath>

#include "pendcore/arithmetic/power.hpp"
#include "pendcore/integrate/loop/attempt.hpp"
#include "pendcore/integrate/runge_kutta/tableau.hpp"

namespace pendcore {

/// 1/k - 3/4 beta
constexpr double exponent(const MethodInfo& method) {
  return 1.0 / (method.error_order + 1) - 0.75 * method.beta;
}

struct StepControl {
  static constexpr double log2_smallest_error = -13.287712379549449;  // log2(1e-4)

  double log2_error_before = log2_smallest_error;
  bool after_rejection = false;

  double gain(const MethodInfo& method) const {
    return method.log2_safety + method.beta * log2_error_before;
  }

  /// The factor for the step after an accepted one.
  double accept(const MethodInfo& method, const Attempt& attempt) {
    const double largest = after_rejection ? 1.0 : method.growth;
    const double log2_error = 0.5 * approximate_log2(attempt.squared_error);
    log2_error_before = std::max(log2_error, log2_smallest_error);
    after_rejection = false;
    return std::clamp(attempt.factor, method.shrink, largest);
  }

  /// The factor for the retry of a rejected step; the method's `retry` if the error is not finite.
  double reject(const MethodInfo& method, const Attempt& attempt) {
    after_rejection = true;
    if (!std::isfinite(attempt.squared_error)) return method.retry;
    const double log2_error = 0.5 * approximate_log2(attempt.squared_error);
    const double log2_factor = method.log2_safety - exponent(method) * log2_error;
    return std::max(approximate_exp2(log2_factor), method.shrink);
  }
};

}  // namespace pendcore
