/// \file
/// How long the next step is, and where a step ends, for one trajectory or for one in each lane of
/// a pack: `Real` is a double or a pack.
///
/// The size follows from the error of this step by PI control:
///
///     h_next = h clamp(safety err^-(1/k - 3/4 beta) err_before^beta, shrink, growth)
///     k = error_order + 1
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

#include "arithmetic/epsilon.hpp"
#include "arithmetic/pack.hpp"
#include "arithmetic/power.hpp"
#include "integrate/loop/attempt.hpp"
#include "integrate/runge_kutta/tableau.hpp"

namespace pendcore {

/// The last step may be longer by this factor (Hairer's rule).
inline constexpr double last_step_stretch = 1.01;
/// A step of at most this many last bits of time resolves nothing.
inline constexpr double few_bits = 10.0;
/// s; a shorter step is too small.
inline constexpr double least_step = 1e-300;

/// 1/k - 3/4 beta
constexpr double exponent(const MethodInfo& method) {
  return 1.0 / (method.error_order + 1) - 0.75 * method.beta;
}

/// log2(err)
template <class Real>
PENDCORE_INLINE Real log2_of_error(const ErrorAndFactor<Real>& found) {
  return 0.5 * approximate_log2(found.squared_error);
}

/// The factor for the step after an accepted one.
template <class Real>
PENDCORE_INLINE Real factor_if_accepted(const MethodInfo& method, const Real& factor,
                                        const Condition<Real>& after_rejection) {
  const Real shrink = broadcast<Real>(method.shrink);
  const Real most = after_rejection ? broadcast<Real>(1.0) : broadcast<Real>(method.growth);
  return factor < shrink ? shrink : most < factor ? most : factor;
}

/// The factor for the retry of a rejected step with a finite error.
template <class Real>
PENDCORE_INLINE Real factor_if_rejected(const MethodInfo& method, const Real& log2_error) {
  const Real log2_factor = method.log2_safety - exponent(method) * log2_error;
  return larger_or_first(approximate_exp2(log2_factor), broadcast<Real>(method.shrink));
}

/// A step of this size, or of max_step if that is shorter.
template <class Real>
PENDCORE_INLINE Real limited(const Real& h, const Real& max_step) {
  return absolute(h) >= max_step ? (h < 0.0 ? Real(-max_step) : max_step) : h;
}

/// A few times the spacing of doubles at these times: times within this distance count as the same.
template <class Real>
PENDCORE_INLINE Real last_bits(const Real& t, const Real& t_new) {
  return last_bits_share * larger_or_first(absolute(t), absolute(t_new));
}

/// How far a step of size h may lead, s: it may be stretched to its target, but not beyond
/// max_step.
template <class Real>
PENDCORE_INLINE Real reach(const Real& h, const Real& max_step) {
  const Real size = absolute(h);
  const Real stretched = last_step_stretch * size;
  const Real allowed = larger_or_first(size, max_step);
  return allowed < stretched ? allowed : stretched;
}

/// Whether a step of size h at time t resolves nothing.
template <class Real>
PENDCORE_INLINE Condition<Real> is_too_small(const Real& h, const Real& t) {
  const Real size = absolute(h);
  const Condition<Real> is_lost = is_at_most(size, Real(few_bits * epsilon * absolute(t)));
  const Condition<Real> is_below = is_less(size, broadcast<Real>(least_step));
  return is_lost | is_below;
}

/// Whether a step of size h ends at its target, which it missed by so much, or beyond it.
template <class Real>
PENDCORE_INLINE Condition<Real> lands(const Real& h, const Real& missed, const Real& bits) {
  return is_at_most(h < 0.0 ? Real(-missed) : missed, bits);
}

/// What the control of a single run keeps between steps.
struct StepControl {
  static constexpr double log2_smallest_error = -13.287712379549449;  // log2(1e-4)

  double log2_error_before = log2_smallest_error;
  bool after_rejection = false;

  double gain(const MethodInfo& method) const {
    return method.log2_safety + method.beta * log2_error_before;
  }

  /// The factor for the step after an accepted one.
  double accept(const MethodInfo& method, const Attempt& attempt) {
    const double factor = factor_if_accepted(method, attempt.factor, after_rejection);
    log2_error_before = std::max(log2_of_error(attempt), log2_smallest_error);
    after_rejection = false;
    return factor;
  }

  /// The factor for the retry of a rejected step; the method's `retry` if the error is not finite.
  double reject(const MethodInfo& method, const Attempt& attempt) {
    after_rejection = true;
    if (!std::isfinite(attempt.squared_error)) return method.retry;
    return factor_if_rejected(method, log2_of_error(attempt));
  }
};

}  // namespace pendcore
