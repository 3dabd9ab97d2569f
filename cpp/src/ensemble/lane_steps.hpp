/// \file
/// What integrate/loop does around a step of a run, for a trajectory in each lane: where the step
/// ends, whether it is accepted, how long the next one is. The rules are those of step_control.hpp,
/// so that each lane has the bits of its run alone; what they decide is selected, not branched to.
#pragma once

#include <limits>
#include <span>

#include "arithmetic/instruction_set.hpp"
#include "arithmetic/pack.hpp"
#include "arithmetic/power.hpp"
#include "arithmetic/two_double.hpp"
#include "integrate/loop/step_control.hpp"
#include "integrate/loop/stiffness.hpp"
#include "simulate/event_levels.hpp"

namespace pendcore {

/// As many lanes as a register of the processor holds.
constexpr int width_on(InstructionSet set) { return set == InstructionSet::x86_64_v4 ? 8 : 4; }

/// What the steps of all lanes have in common.
struct LaneInterval {
  double t_end;  ///< s
  double max_step = std::numeric_limits<double>::infinity();
  long long max_steps = std::numeric_limits<long long>::max();
};

/// For each lane a bit.
using LaneBits = unsigned;

/// The lanes that need attention after a round of steps.
struct Attention {
  LaneBits ended = 0;       ///< at the end of the interval
  LaneBits used_up = 0;     ///< max_steps were attempted
  LaneBits runs_alone = 0;  ///< they leave the lanes
  LaneBits looks = 0;       ///< their stiffness is to be looked at
  LaneBits searched = 0;    ///< the dense output of their step is to be searched for events
  LaneBits sampled = 0;     ///< a time that is asked for lies within their step
  LaneBits recorded = 0;    ///< something may be recorded of their step
  bool is_needed() const {
    return (ended | used_up | runs_alone | looks | searched | recorded) != 0;
  }
};

/// Where the trajectories of all lanes stand, except their states.
template <int width>
struct LaneSteps {
  using Real = Pack<width>;
  using Integers = typename Lanes<Real>::Integers;

  Real t = {}, t_low = {};  ///< s, a sum of two numbers
  Real h = {};              ///< s, the step to try next
  Real log2_error_before = {};
  Integers after_rejection = {};  ///< all bits set where the last attempt was rejected
  Integers accepted = {}, rejected = {};
  Integers steps_to_look = {};  ///< accepted steps until stiffness is looked at

  /// The step that was taken last: its start, s, and its size.
  Real t_before = {}, t_low_before = {}, h_before = {};
  Real next_time = {};  ///< s, at which a state is asked for; infinite if there is none
  /// All events, if each is a level of an angle or a rate; else every step is recorded.
  std::span<const Difference> differences;
  LaneBits active = 0;     ///< the lanes that have a member
  bool has_times = false;  ///< whether states at given times are asked for
  bool every_step_is_recorded = false;
  bool needs_dense_output = false;       ///< whether some steps have it
  bool interpolates_every_step = false;  ///< whether all have it in a single run
};

namespace lanes_detail {

/// The bits of all lanes in one number.
template <class Integers>
PENDCORE_INLINE LaneBits joined_bits(const Integers& x) {
  constexpr int width = sizeof(Integers) / sizeof(long long);
  if constexpr (width == 8) {
    return joined_bits(__builtin_shufflevector(x, x, 0, 1, 2, 3) |
                       __builtin_shufflevector(x, x, 4, 5, 6, 7));
  } else if constexpr (width == 4) {
    return joined_bits(__builtin_shufflevector(x, x, 0, 1) | __builtin_shufflevector(x, x, 2, 3));
  } else {
    return static_cast<LaneBits>(x[0] | x[1]);
  }
}
/// The lanes, as bits, in which a comparison holds: those whose bits are all set.
template <class Integers>
PENDCORE_INLINE LaneBits bits_of(const Integers& holds) {
  constexpr int width = sizeof(Integers) / sizeof(long long);
  Integers bit_of_lane;
  for (int i = 0; i < width; ++i) bit_of_lane[i] = 1LL << i;
  return joined_bits(holds & bit_of_lane);
}

/// Whether a difference may reach its level within a step of x, whose dense output is a polynomial
/// with rows of `size` numbers, from the first power on, and which begins at y: not if the level is
/// farther away than the sizes of all terms together.
template <class Real>
PENDCORE_INLINE typename Lanes<Real>::Integers may_reach(const Difference& level, const Real* y,
                                                         const Real* powers, std::ptrdiff_t size,
                                                         int degree, const Real& x) {
  constexpr double turn = Levels::turn;
  const auto difference = [&](const Real* row) __attribute__((always_inline)) {
    return level.minus < 0 ? row[level.plus] : Real(row[level.plus] - row[level.minus]);
  };
  const Real step = absolute(x);
  Real moves{};
  for (int k = degree - 1; k >= 0; --k) {
    moves = (moves + absolute(difference(powers + k * size))) * step;
  }
  const Real here = difference(y);
  Real away = here - level.value;
  if (level.every_turn) {
    using power_detail::to_integer;
    const Real turns = (away * (1.0 / turn) + to_integer) - to_integer;
    away = away - turns * turn;
  }
  constexpr double rounding = 1e-9;
  const typename Lanes<Real>::Integers is_too_far =
      absolute(away) > moves * (1.0 + rounding) + rounding * (1.0 + absolute(here));
  return ~is_too_far;  // what is not a number may reach it
}

}  // namespace lanes_detail

/// Whether an event may lie within a step of x: see may_reach().
template <int width, class Real>
PENDCORE_INLINE typename LaneSteps<width>::Integers may_have_event(const LaneSteps<width>& lanes,
                                                                   const Real* y,
                                                                   const Real* powers,
                                                                   std::ptrdiff_t size, int degree,
                                                                   const Real& x) {
  typename LaneSteps<width>::Integers may_happen{};
  for (const Difference& one : lanes.differences) {
    may_happen |= lanes_detail::may_reach(one, y, powers, size, degree, x);
  }
  return may_happen;
}

/// The step that is tried next in each lane.
template <int width>
struct NextStep {
  using Real = Pack<width>;
  using Integers = typename Lanes<Real>::Integers;
  Real h;                ///< s
  Real bits;             ///< s, a few last bits of the time
  Integers is_in_reach;  ///< whether it leads to the end of the interval
  Integers runs_alone;   ///< whether it is too small for the lanes
};

template <int width>
PENDCORE_INLINE NextStep<width> next_step(const LaneSteps<width>& lanes,
                                          const LaneInterval& interval) {
  using Real = Pack<width>;
  const Real t_end = broadcast<Real>(interval.t_end);
  const Real left = difference(t_end, TwoNumbers<Real>{lanes.t, lanes.t_low});
  NextStep<width> next;
  next.bits = last_bits(lanes.t, t_end);
  next.is_in_reach = is_at_most(
      absolute(left), Real(reach(lanes.h, broadcast<Real>(interval.max_step)) + next.bits));
  next.runs_alone = is_too_small(lanes.h, lanes.t) |
                    (next.is_in_reach & is_at_most(absolute(left), Real(few_bits * next.bits)));
  next.h = next.is_in_reach ? left : lanes.h;
  return next;
}

/// Accepts or rejects the steps that were `tried` (all bits set), and notes what needs attention. A
/// step that has a kink, at a share of it below 1, is taken again to end there.
/// Returns where a step was accepted; there, the end of the step is the time that lanes have now.
template <const auto& method, int width>
PENDCORE_INLINE typename NextStep<width>::Integers finish_step(
    LaneSteps<width>& lanes, const LaneInterval& interval, const NextStep<width>& next,
    const ErrorAndFactor<Pack<width>>& found, const typename NextStep<width>::Integers& runs_alone,
    const typename NextStep<width>::Integers& tried, Attention& attention,
    const Pack<width>* first_kink = nullptr) {
  namespace detail = lanes_detail;
  using Real = Pack<width>;
  using Integers = typename NextStep<width>::Integers;
  constexpr const MethodInfo& info = method.info;
  const Real t_end = broadcast<Real>(interval.t_end);
  const Real max_step = broadcast<Real>(interval.max_step);
  const Real h = next.h;
  const Integers is_right = is_at_most(found.squared_error, broadcast<Real>(1.0));
  Integers has_kink{};
  Real to_kink = h;
  if (first_kink != nullptr) {
    to_kink = h * *first_kink;
    has_kink = is_less(absolute(to_kink), absolute(h)) & ~is_too_small(to_kink, lanes.t);
  }
  const Integers is_accepted = is_right & ~has_kink & tried;
  const Integers is_rejected = ~is_accepted & tried;

  const Real log2_error = log2_of_error(found);
  const Real longer =
      limited(Real(h * factor_if_accepted(info, found.factor, lanes.after_rejection)), max_step);
  Real shorter = lanes.h;
  if ((detail::bits_of(is_rejected) & lanes.active) != 0) {
    shorter = h * factor_if_rejected(info, log2_error);
    if (first_kink != nullptr) shorter = has_kink ? to_kink : shorter;
  }
  const Real smallest = broadcast<Real>(StepControl::log2_smallest_error);
  lanes.log2_error_before =
      is_accepted ? larger_or_first(log2_error, smallest) : lanes.log2_error_before;
  lanes.after_rejection = (is_rejected & ~has_kink) | (lanes.after_rejection & has_kink);
  lanes.accepted -= is_accepted;
  lanes.rejected -= is_rejected;
  lanes.steps_to_look += is_accepted;
  lanes.h = is_accepted ? longer : is_rejected ? shorter : lanes.h;

  const TwoNumbers<Real> t{lanes.t, lanes.t_low};
  const TwoNumbers<Real> after = t + h;
  const Integers is_at_end = next.is_in_reach & lands(h, difference(t_end, after), next.bits);
  lanes.t_before = lanes.t;
  lanes.t_low_before = lanes.t_low;
  lanes.h_before = h;
  lanes.t = is_accepted ? (is_at_end ? t_end : after.high) : t.high;
  lanes.t_low = is_accepted ? (is_at_end ? Real{} : after.low) : t.low;

  const Integers has_ended = is_accepted & (lanes.t == t_end);
  const Integers max_steps = interval.max_steps - Integers{};
  const Integers is_used_up = ~has_ended & (lanes.accepted + lanes.rejected >= max_steps);
  if ((detail::bits_of(runs_alone | has_ended | is_used_up) & lanes.active) != 0) {
    attention.runs_alone = detail::bits_of(runs_alone) & lanes.active;
    attention.ended = detail::bits_of(has_ended) & lanes.active & ~attention.runs_alone;
    attention.used_up = detail::bits_of(is_used_up) & lanes.active & ~attention.runs_alone;
  }
  const LaneBits usual = lanes.active & ~attention.runs_alone;
  if (lanes.has_times) {
    const Real missing = lanes.next_time - lanes.t;
    const Real ahead = h < 0.0 ? Real(-missing) : missing;
    attention.sampled = detail::bits_of(is_at_most(ahead, Real{}) & is_accepted) & usual;
  }
  attention.recorded =
      lanes.every_step_is_recorded ? detail::bits_of(is_accepted) & usual : attention.sampled;
  if (!lanes.differences.empty()) attention.searched = detail::bits_of(is_accepted) & usual;
  return is_accepted;
}

}  // namespace pendcore
