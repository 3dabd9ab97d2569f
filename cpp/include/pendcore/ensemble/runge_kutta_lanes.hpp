/// \file
/// Explicit Runge-Kutta steps of several trajectories at once: the kernel of a step is that of a
/// single run (integrate/runge_kutta/step.hpp), on packs.
#pragma once

#include <tuple>

#include "pendcore/dynamics/first_order.hpp"
#include "pendcore/ensemble/lane_steps.hpp"
#include "pendcore/ensemble/one_link_in_lanes.hpp"
#include "pendcore/integrate/runge_kutta/step.hpp"

namespace pendcore {

/// The lanes of a method on a form of the equations.
template <const auto& method, class Form, int width>
struct RungeKuttaLanes : LaneSteps<width> {
  using Real = Pack<width>;
  using Equations = LaneEquations<Form, Real>;
  using System = FirstOrder<typename Equations::Type>;
  using Memory = StepMemory<method, System>;
  static constexpr int stages = Memory::stages;
  static_assert(method.first_same_as_last && method.info.error_order > 0);

  Memory memory;
};

/// Takes up to `rounds` steps in each lane, until some need attention.
template <const auto& method, class Form, int width>
PENDCORE_INLINE Attention take_steps(RungeKuttaLanes<method, Form, width>* all,
                                     const LaneInterval* interval, int rounds) {
  namespace detail = lanes_detail;
  using All = RungeKuttaLanes<method, Form, width>;
  using Real = typename All::Real;
  using Integers = typename All::Integers;
  auto& memory = all->memory;
  Attention attention;
  for (int round = 0; round < rounds && !attention.is_needed(); ++round) {
    const NextStep<width> next = next_step<width>(*all, *interval);
    const Real gain = method.info.log2_safety + method.info.beta * all->log2_error_before;
    const ErrorAndFactor<Real> found = judged_step(&memory, all->t, next.h, gain);
    Integers is_odd =
        next.is_odd | ~(found.squared_error < std::numeric_limits<double>::infinity());

    if constexpr (method.info.stability != 0.0) {
      const Integers is_looked_at = (all->steps_to_look == 0) & (found.squared_error <= 1.0);
      if (detail::bits_of(is_looked_at) != 0) [[unlikely]] {
        const Real stiffness =
            stiffness_of_step<method, Real>(next.h, All::Memory::blocks, [&](int i) {
              return std::tuple(memory.y[i], memory.y_new[i], StageBlock(memory.k, i));
            });
        is_odd |= is_looked_at & (stiffness > method.info.stability);
        all->steps_to_look = is_looked_at ? Integers{} + stiffness_looks_every : all->steps_to_look;
      }
    }
    const Integers all_tried = Integers{} - 1;
    const Integers is_accepted =
        finish_step<method, width>(*all, *interval, next, found, is_odd, all_tried, attention);
    for (int i = 0; i < All::Memory::blocks; ++i) {
      memory.y[i] = All::Equations::select(is_accepted, memory.y_new[i], memory.y[i]);
      memory.k[0][i] =
          All::Equations::select(is_accepted, memory.k[All::stages - 1][i], memory.k[0][i]);
    }
  }
  return attention;
}

}  // namespace pendcore
