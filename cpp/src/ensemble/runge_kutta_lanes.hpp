/// \file
/// Explicit Runge-Kutta steps of several trajectories at once: the kernel of a step is that of a
/// single run (integrate/runge_kutta/step.hpp), on packs.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <tuple>
#include <utility>

#include "dynamics/ends_in_air.hpp"
#include "dynamics/first_order.hpp"
#include "ensemble/few_links_in_lanes.hpp"
#include "ensemble/lane_steps.hpp"
#include "integrate/runge_kutta/step.hpp"

namespace pendcore {

/// A form of the equations that a step calls: one step of a method serves all forms with such rows.
/// One link or two with couples alone, and three links, take 4 to 12 % less if they are written
/// into the step. With other effects nothing is lost, and dopri5 takes 13 % less with a law in a
/// list, whose loop would part the registers of the step.
template <class Real, class Row>
struct CalledEquations {
  using Links = Row;
  static constexpr bool may_have_drag = true;

  std::shared_ptr<void> form;  ///< the form as a first-order system
  /// Computes the derivative of a state (q, qd).
  void (*compute)(const void* form, const Real& t, const Row* y, Row* dydt);
  // As lane_equations.hpp says.
  std::function<void(const Scene&, const EquationsOfMotion&)> prepare;
  std::function<void(int lane, const Scene&, const EquationsOfMotion&)> put;
  std::function<const Drives<Real>*()> drives;

  PENDCORE_INLINE void derivative(const Real& t, const Row* y, Row* dydt) const {
    compute(form.get(), t, y, dydt);
  }
};
template <class System, class Real, class Row>
PENDCORE_INLINE void derivative_in_lanes(const void* form, const Real& t, const Row* y, Row* dydt) {
  (*static_cast<const System*>(form))(t, y, dydt);
}

/// The lanes of a method on equations: a form that is written into the step, or CalledEquations.
template <const auto& method, class Equations, int width>
struct RungeKuttaLanes : LaneSteps<width> {
  using Real = Pack<width>;
  using Memory = StepMemory<method, FirstOrder<Equations>>;
  using Block = typename Memory::Block;
  static constexpr int stages = Memory::stages;
  static constexpr int links = links_in_row<Block>;
  static constexpr int size = 2 * links;
  static constexpr bool may_end_at_kinks =
      Equations::may_have_drag && method.info.ends_at_kinks_from > 0.0;
  static_assert(method.first_same_as_last && method.info.error_order > 0);

  Memory memory;
  EndsInAir<Real> air;  ///< none where steps do not end at kinks of drag
  typename EndsInAir<Real>::Speeds speeds, speeds_after;  ///< at the start of a step, and its end
  bool are_speeds_known = false;                          ///< at the start
  Real first_kink = {};                                   ///< as a share of the attempted step
  /// Is find_first_kinks() below: called, because written into a step it spills its registers.
  void (*find_kinks)(RungeKuttaLanes* all, const Real& h) = nullptr;
  // For dense output:
  Block y_before[Memory::blocks] = {};      ///< the state before the last step
  Block rates_before[Memory::blocks] = {};  ///< its derivative
  /// The dense output of the last step in powers of theta, (degree + 1) rows of a state.
  Real rows[(Memory::degree + 1) * size] = {};
};

/// Makes a row another one in some lanes.
template <class Integers, class Row>
PENDCORE_INLINE void select(const Integers& which, const Row& other, Row& row) {
#pragma GCC unroll 4
  for (int i = 0; i < links_in_row<Row>; ++i) {
    set_number(row, i, which ? number_of(other, i) : number_of(row, i));
  }
}

/// Computes the dense output of the last step of each lane. Returns the lanes in which an event may
/// lie within it.
template <const auto& method, class Equations, int width>
PENDCORE_INLINE LaneBits interpolate_step(RungeKuttaLanes<method, Equations, width>* all) {
  using All = RungeKuttaLanes<method, Equations, width>;
  using Memory = typename All::Memory;
  using Real = typename All::Real;
  constexpr int links = All::links;
  auto& memory = all->memory;
  const auto swap_rates = [all, &memory] {
    for (int i = 0; i < Memory::blocks; ++i) std::swap(memory.k[0][i], all->rates_before[i]);
  };
  swap_rates();
  if constexpr (Memory::all_stages > Memory::stages) {
    typename All::Block z[Memory::blocks];
    evaluate_stages<method, Memory::stages, Memory::all_stages>(
        memory.system, all->t_before, all->h_before, all->y_before, memory.k, z);
  }
  for (int i = 0; i < Memory::blocks; ++i) {
    typename All::Block powers[Memory::degree];
    interpolant_of_block<method>(all->h_before, StageBlock(memory.k, i), powers);
    for (int link = 0; link < links; ++link) {
      Real* const column = all->rows + i * links + link;
      column[0] = number_of(all->y_before[i], link);
      for (int p = 0; p < Memory::degree; ++p) {
        column[static_cast<std::ptrdiff_t>(p + 1) * All::size] = number_of(powers[p], link);
      }
    }
  }
  swap_rates();
  return lanes_detail::bits_of(may_have_event(*all, all->rows, all->rows + All::size, All::size,
                                              Memory::degree, broadcast<Real>(1.0)));
}

/// The numbers of a state, (q, qd), from its two rows.
template <class Real, class Row>
PENDCORE_INLINE auto numbers_of(const Row* rows) {
  constexpr int links = links_in_row<Row>;
  std::array<Real, 2 * static_cast<std::size_t>(links)> numbers;
  for (int i = 0; i < 2; ++i) {
    for (int link = 0; link < links; ++link) numbers[i * links + link] = number_of(rows[i], link);
  }
  return numbers;
}

/// Computes the shares of the attempted steps, of size h, at which their first kinks lie. The
/// speeds at their starts are those at the ends of the steps before, where these were accepted.
template <const auto& method, class Equations, int width>
PENDCORE_INLINE void find_first_kinks(RungeKuttaLanes<method, Equations, width>* all,
                                      const Pack<width>& h) {
  using All = RungeKuttaLanes<method, Equations, width>;
  using Real = typename All::Real;
  const auto& memory = all->memory;
  if (!all->are_speeds_known) {
    const auto start = numbers_of<Real>(memory.y);
    const auto slopes = numbers_of<Real>(memory.k[0]);
    all->air.find(all->t, start.data(), slopes.data(), all->speeds);
  }
  all->are_speeds_known = !all->air.depend_on_time();
  const Real t_new = all->t + h;
  const auto end = numbers_of<Real>(memory.y_new);
  const auto slopes = numbers_of<Real>(memory.k[All::stages - 1]);
  all->air.find(t_new, end.data(), slopes.data(), all->speeds_after);
  all->first_kink = all->air.first_kink(h, all->speeds, all->speeds_after);
}

/// Takes up to `rounds` steps in each lane, until some need attention.
template <const auto& method, class Equations, int width>
PENDCORE_INLINE Attention take_steps(RungeKuttaLanes<method, Equations, width>* all,
                                     const LaneInterval* interval, int rounds) {
  namespace detail = lanes_detail;
  using All = RungeKuttaLanes<method, Equations, width>;
  using Real = typename All::Real;
  using Integers = typename All::Integers;
  auto& memory = all->memory;
  Attention attention;
  for (int round = 0; round < rounds && !attention.is_needed(); ++round) {
    const NextStep<width> next = next_step<width>(*all, *interval);
    const Real gain = method.info.log2_safety + method.info.beta * all->log2_error_before;
    const ErrorAndFactor<Real> found = judged_step(&memory, all->t, next.h, gain);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Integers runs_alone =
        next.runs_alone | ~is_less(found.squared_error, broadcast<Real>(infinity));

    if constexpr (method.info.stability != 0.0) {
      const Integers is_looked_at =
          (all->steps_to_look == 0) & is_at_most(found.squared_error, broadcast<Real>(1.0));
      if (detail::bits_of(is_looked_at) != 0) [[unlikely]] {
        const Real stiffness =
            stiffness_of_step<method, Real>(next.h, All::Memory::blocks, [&](int i) {
              return std::tuple(memory.y[i], memory.y_new[i], StageBlock(memory.k, i));
            });
        runs_alone |= is_looked_at & is_less(broadcast<Real>(method.info.stability), stiffness);
        all->steps_to_look = is_looked_at ? Integers{} + stiffness_looks_every : all->steps_to_look;
      }
    }
    const Integers all_tried = Integers{} - 1;
    const bool is_in_air = All::may_end_at_kinks && all->air.count() != 0;
    if (is_in_air) all->find_kinks(all, next.h);
    const Integers is_accepted =
        finish_step<method, width>(*all, *interval, next, found, runs_alone, all_tried, attention,
                                   is_in_air ? &all->first_kink : nullptr);
    if (all->needs_dense_output) {
      for (int i = 0; i < All::Memory::blocks; ++i) {
        all->y_before[i] = memory.y[i];
        all->rates_before[i] = memory.k[0][i];
      }
    }
    for (int i = 0; i < All::Memory::blocks; ++i) {
      select(is_accepted, memory.y_new[i], memory.y[i]);
      select(is_accepted, memory.k[All::stages - 1][i], memory.k[0][i]);
    }
    for (int end = 0; is_in_air && end < all->air.count(); ++end) {
      all->speeds.w.set(end, is_accepted ? all->speeds_after.w[end] : all->speeds.w[end]);
      all->speeds.slope.set(end,
                            is_accepted ? all->speeds_after.slope[end] : all->speeds.slope[end]);
    }
  }
  return attention;
}

}  // namespace pendcore
