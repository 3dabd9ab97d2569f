/// \file
/// Explicit Runge-Kutta steps of several trajectories at once.
///
/// `take_steps` is the kernel: for each lane it does what integrate/loop does for a run, by the
/// same operations, as selects instead of branches. It returns when a lane needs attention: its
/// member has ended, or is to be run alone.
#pragma once

#include <array>
#include <limits>

#include "pendcore/arithmetic/epsilon.hpp"
#include "pendcore/dynamics/first_order.hpp"
#include "pendcore/ensemble/lane_equations.hpp"
#include "pendcore/integrate/loop/step_control.hpp"
#include "pendcore/integrate/loop/stiffness.hpp"
#include "pendcore/integrate/loop/trial.hpp"
#include "pendcore/integrate/runge_kutta/step.hpp"

namespace pendcore {

/// What the steps of all lanes have in common.
struct LaneInterval {
  double t_end;  ///< s
  double max_step = std::numeric_limits<double>::infinity();
  long long max_steps = std::numeric_limits<long long>::max();
};

/// For each lane a bit.
using LaneBits = unsigned;

/// The lanes that need attention.
struct Attention {
  LaneBits ended = 0;    ///< at the end of the interval
  LaneBits used_up = 0;  ///< max_steps were attempted
  LaneBits odd = 0;      ///< to be run alone
  bool is_needed() const { return (ended | used_up | odd) != 0; }
};

namespace lanes_detail {

/// Whether each lane of a comparison holds, as bits.
template <class Integers>
PENDCORE_INLINE LaneBits bits_of(const Integers& holds) {
  constexpr int width = sizeof(Integers) / sizeof(long long);
  LaneBits bits = 0;
  for (int i = 0; i < width; ++i) bits |= static_cast<LaneBits>(holds[i] & 1) << i;
  return bits;
}

/// a + b as an unevaluated sum of two numbers in each lane (arithmetic/two_double.hpp).
template <class Real>
struct TwoReals {
  Real high, low;
};
template <class Real>
PENDCORE_INLINE TwoReals<Real> exact_sum(const Real& a, const Real& b) {
  const Real sum = a + b;
  return {sum, left_over(a, b, sum)};
}
template <class Real>
PENDCORE_INLINE TwoReals<Real> operator+(const TwoReals<Real>& a, const Real& b) {
  const TwoReals<Real> sum = exact_sum(a.high, b);
  return exact_sum(sum.high, Real(sum.low + a.low));
}
/// b - a, rounded.
template <class Real>
PENDCORE_INLINE Real difference(const Real& b, const TwoReals<Real>& a) {
  const TwoReals<Real> sum = exact_sum(b, Real(-a.high));
  return sum.high + (sum.low - a.low);
}

}  // namespace lanes_detail

/// The lanes of a method on a form of the equations.
template <const auto& method, class Form, int width>
struct RungeKuttaLanes {
  using Real = Pack<width>;
  using Integers = typename Lanes<Real>::Integers;
  using Equations = LaneEquations<Form, Real>;
  using System = FirstOrder<typename Equations::Type>;
  using Memory = StepMemory<method, System>;
  static constexpr int stages = Memory::stages;
  static_assert(method.first_same_as_last && method.info.error_order > 0);

  Memory memory;
  Real t = {}, t_low = {};  ///< s
  Real h = {};              ///< s, the step to try next
  Real log2_error_before = {};
  Integers after_rejection = {};  ///< all bits set where the last attempt was rejected
  Integers accepted = {}, rejected = {};
  Integers steps_to_look = {};  ///< accepted steps until stiffness is looked at
  LaneBits active = 0;
};

/// Takes up to `rounds` steps in each lane, until some need attention.
template <const auto& method, class Form, int width>
PENDCORE_INLINE Attention take_steps(RungeKuttaLanes<method, Form, width>* all,
                                     const LaneInterval* interval, int rounds) {
  namespace detail = lanes_detail;
  using All = RungeKuttaLanes<method, Form, width>;
  using Real = typename All::Real;
  using Integers = typename All::Integers;
  constexpr const MethodInfo& info = method.info;
  constexpr int stages = All::stages;
  const Real t_end = broadcast<Real>(interval->t_end);
  const Real max_step = broadcast<Real>(interval->max_step);
  const Integers max_steps = interval->max_steps - Integers{};
  const auto larger_of = [](const Real& a, const Real& b) { return a < b ? b : a; };
  auto& memory = all->memory;

  Attention attention;
  for (int round = 0; round < rounds && !attention.is_needed(); ++round) {
    const detail::TwoReals<Real> t{all->t, all->t_low};
    const Real left = detail::difference(t_end, t);
    const Real size = absolute(all->h);
    const Real stretched = 1.01 * size;
    const Real allowed = larger_of(size, max_step);
    const Real reach = allowed < stretched ? allowed : stretched;
    const Real bits = last_bits_share * larger_of(absolute(t.high), absolute(t_end));
    const Integers is_in_reach = absolute(left) <= reach + bits;
    Integers is_odd = (size <= few * epsilon * absolute(t.high)) | (size < 1e-300) |
                      (is_in_reach & (absolute(left) <= few * bits));
    const Real h = is_in_reach ? left : all->h;

    const Real gain = info.log2_safety + info.beta * all->log2_error_before;
    const ErrorAndFactor<Real> found = judged_step(&memory, t.high, h, gain);
    const Real squared_error = found.squared_error;
    is_odd |= ~(squared_error < std::numeric_limits<double>::infinity());
    const Integers is_accepted = squared_error <= 1.0;

    if constexpr (info.stability != 0.0) {
      const Integers is_looked_at = (all->steps_to_look == 0) & is_accepted;
      if (detail::bits_of(is_looked_at) != 0) [[unlikely]] {
        const Real stiffness = stiffness_of_step<method, Real>(h, All::Memory::blocks, [&](int i) {
          return std::tuple(memory.y[i], memory.y_new[i], StageBlock(memory.k, i));
        });
        is_odd |= is_looked_at & (stiffness > info.stability);
        all->steps_to_look = is_looked_at ? Integers{} + stiffness_looks_every : all->steps_to_look;
      }
      all->steps_to_look += is_accepted;
    }

    // The step control of step_control.hpp, and the loop's bound on the next step.
    const Real log2_error = 0.5 * approximate_log2(squared_error);
    const Real most = all->after_rejection ? broadcast<Real>(1.0) : broadcast<Real>(info.growth);
    const Real factor = found.factor < info.shrink ? broadcast<Real>(info.shrink)
                        : most < found.factor      ? most
                                                   : found.factor;
    Real next = h * factor;
    next = absolute(next) >= max_step ? (h < 0.0 ? Real(-max_step) : max_step) : next;
    const LaneBits accepted = detail::bits_of(is_accepted);
    if ((accepted & all->active) != all->active) {
      const Real log2_factor = info.log2_safety - exponent(info) * log2_error;
      const Real shorter = larger_of(approximate_exp2(log2_factor), broadcast<Real>(info.shrink));
      next = is_accepted ? next : Real(h * shorter);
    }
    const Real smallest = broadcast<Real>(StepControl::log2_smallest_error);
    all->log2_error_before = is_accepted ? larger_of(log2_error, smallest) : all->log2_error_before;
    all->after_rejection = ~is_accepted;
    all->accepted -= is_accepted;
    all->rejected -= ~is_accepted;
    all->h = next;

    const detail::TwoReals<Real> after = t + h;
    const Real missed =
        h < 0.0 ? Real(-detail::difference(t_end, after)) : detail::difference(t_end, after);
    const Integers lands = is_in_reach & (missed <= bits);
    const Real t_new = lands ? t_end : after.high;
    const Real t_new_low = lands ? Real{} : after.low;
    all->t = is_accepted ? t_new : t.high;
    all->t_low = is_accepted ? t_new_low : t.low;
    for (int i = 0; i < 2; ++i) {
      memory.y[i] = All::Equations::select(is_accepted, memory.y_new[i], memory.y[i]);
      memory.k[0][i] = All::Equations::select(is_accepted, memory.k[stages - 1][i], memory.k[0][i]);
    }

    const Integers has_ended = is_accepted & (all->t == t_end);
    const Integers is_used_up = ~has_ended & (all->accepted + all->rejected >= max_steps);
    if ((detail::bits_of(is_odd | has_ended | is_used_up) & all->active) == 0) continue;
    attention.odd = detail::bits_of(is_odd) & all->active;
    attention.ended = detail::bits_of(has_ended) & all->active & ~attention.odd;
    attention.used_up = detail::bits_of(is_used_up) & all->active & ~attention.odd;
  }
  return attention;
}

}  // namespace pendcore
