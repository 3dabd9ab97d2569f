/// \file
/// WHERE IS THE STEPPER: one step of an explicit Runge-Kutta method, from its table.
///
/// `attempt_step` is the kernel: the stages, the new state and its error norm, unrolled for the
/// table and the system at compile time. It allocates nothing and branches on nothing itself.
/// explicit_runge_kutta.hpp clones it for each instruction set and hands it to the loop.
///
/// A system is a type with `Block` (a double or a pack), `blocks` (how many make a state) and
/// operator()(t, y, dydt) on blocks.
///
/// A `compensated` step carries on what the rounding of y_new leaves over (low_part.hpp): the
/// increment h sum b_k k is formed on its own, on top of the low part of y, and its sum with y is
/// split without error.
#pragma once

#include <type_traits>

#include "pendcore/arithmetic/pack.hpp"
#include "pendcore/arithmetic/power.hpp"
#include "pendcore/arithmetic/two_double.hpp"
#include "pendcore/integrate/attempt.hpp"
#include "pendcore/integrate/low_part.hpp"
#include "pendcore/integrate/step_control.hpp"

namespace pendcore {

template <const auto& method, class System, bool is_compensated = false>
struct StepMemory {
  using Block = typename System::Block;
  static constexpr int blocks = System::blocks;
  static constexpr int stages = std::remove_cvref_t<decltype(method)>::stages;
  static constexpr int degree = std::remove_cvref_t<decltype(method)>::degree;
  static constexpr bool compensated = is_compensated;

  System system;
  Block y[blocks] = {};
  Block y_new[blocks] = {};
  Block k[stages][blocks] = {};
  Block rtol[blocks] = {};
  Block atol[blocks] = {};
  [[no_unique_address]] LowPart<Block, blocks, compensated> low = {};
};

/// start + h (sum of weights[j] k(j) over the first `count` stages); terms with weight zero are
/// left out. The last stage is the one that is waited for: it comes in last, its weight times h
/// ready.
template <class Block, class Scale, class Weights, class Stage>
PENDCORE_INLINE Block advance(const Block& start, const Scale& h, const Weights& weights,
                              const Stage& k, int count) {
  int last = count - 1;
  while (last >= 0 && weights[last].numerator == 0) --last;
  if (last < 0) return start;
  Block sum{};
  bool empty = true;
#pragma GCC unroll 16
  for (int j = 0; j < last; ++j) {
    if (weights[j].numerator == 0) continue;
    const Block weight = broadcast<Block>(weights[j].value());
    sum = empty ? Block(weight * k(j)) : fma(weight, k(j), sum);
    empty = false;
  }
  const Block known = empty ? start : fma(h, sum, start);
  return fma(h * weights[last].value(), k(last), known);
}

/// One block of the stages k.
template <class Block, int blocks>
struct StageBlock {
  const Block (*k)[blocks];
  int block;
  PENDCORE_INLINE const Block& operator()(int j) const { return k[j][block]; }
};
template <class Block, int blocks>
StageBlock(const Block (*)[blocks], int) -> StageBlock<Block, blocks>;

/// y + (low + h sum b_k k), rounded; `after` becomes what that leaves over.
template <class Block, class Weights, class Stage>
PENDCORE_INLINE Block advance_compensated(const Block& y, const Block& low, double h,
                                          const Weights& weights, const Stage& k, int count,
                                          Block& after) {
  const Block increment = advance(low, h, weights, k, count);
  const Block sum = y + increment;
  after = left_over(y, increment, sum);
  return sum;
}

/// Tries a step of size h at time t, as Stepper::attempt says.
template <const auto& method, class System, bool compensated>
PENDCORE_INLINE Attempt attempt_step(StepMemory<method, System, compensated>* memory, double t,
                                     double h, double gain) {
  using Memory = StepMemory<method, System, compensated>;
  using Block = typename Memory::Block;
  constexpr int blocks = Memory::blocks;
  constexpr int stages = Memory::stages;

  // Local copies stay in registers; memory is written once, at the end.
  const System system = memory->system;
  Block y[blocks];
  Block z[blocks];
  Block k[stages][blocks];
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    y[i] = memory->y[i];
    k[0][i] = memory->k[0][i];
  }
  // Compensated, a stage at the new state comes on its own.
  constexpr int before_end = stages - (compensated && method.first_same_as_last ? 1 : 0);
#pragma GCC unroll 16
  for (int s = 1; s < before_end; ++s) {
#pragma GCC unroll 16
    for (int i = 0; i < blocks; ++i) z[i] = advance(y[i], h, method.a[s], StageBlock(k, i), s);
    system(t + method.c[s].value() * h, z, k[s]);
  }
  if constexpr (compensated) {
#pragma GCC unroll 16
    for (int i = 0; i < blocks; ++i) {
      z[i] = advance_compensated(y[i], memory->low.before[i], h, method.b, StageBlock(k, i),
                                 before_end, memory->low.after[i]);
    }
    if constexpr (method.first_same_as_last) system(t + h, z, k[stages - 1]);
  } else if constexpr (!method.first_same_as_last) {
#pragma GCC unroll 16
    for (int i = 0; i < blocks; ++i) z[i] = advance(y[i], h, method.b, StageBlock(k, i), stages);
  }

  // The scales wait for y_new only, so their division is done before the last stage is.
  Block squares[blocks];
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    const Block size = larger(absolute(y[i]), absolute(z[i]));
    const Block scale = h / fma(memory->rtol[i], size, memory->atol[i]);
    // Without a stage at the new state nothing else says that it is finite: 0, or NaN.
    const Block start = method.first_same_as_last ? Block{} : z[i] - z[i];
    const Block ratio = advance(start, scale, method.e, StageBlock(k, i), stages);
    squares[i] = ratio * ratio;
  }
#pragma GCC unroll 16
  for (int i = 1; i < blocks; ++i) squares[0] += squares[i];
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    memory->y_new[i] = z[i];
#pragma GCC unroll 16
    for (int s = 1; s < stages; ++s) memory->k[s][i] = k[s][i];
  }
  const double squared_error = sum_of_lanes(squares[0]) * (1.0 / (blocks * Lanes<Block>::width));
  return {squared_error, scaled_power(squared_error, -0.5 * exponent(method.info), gain)};
}

/// coefficient[p] = h sum_s P_sp k_s for p = 1 .. degree, and coefficient[0] = y: the dense output
/// of the attempted step, (degree + 1) rows of a state each.
template <const auto& method, class System, bool compensated>
PENDCORE_INLINE void interpolant_of_step(const StepMemory<method, System, compensated>* memory,
                                         double h, double* coefficients) {
  using Memory = StepMemory<method, System, compensated>;
  using Block = typename Memory::Block;
  constexpr int blocks = Memory::blocks;
  constexpr int width = Lanes<Block>::width;
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    store(coefficients + i * width, memory->y[i]);
#pragma GCC unroll 16
    for (int p = 0; p < Memory::degree; ++p) {
      Block sum{};
#pragma GCC unroll 16
      for (int s = 0; s < Memory::stages; ++s) {
        if (method.interpolant[s][p].numerator == 0) continue;
        sum = fma(broadcast<Block>(method.interpolant[s][p].value()), memory->k[s][i], sum);
      }
      store(coefficients + ((p + 1) * blocks + i) * width, Block(h * sum));
    }
  }
}

/// Horner's scheme in theta = (time - start) / h, at `count` times.
template <class Block, int blocks, int degree>
PENDCORE_INLINE void sample_interpolant(const double* coefficients, TwoDouble start, double h,
                                        const double* times, int count, double* states) {
  constexpr int width = Lanes<Block>::width;
  for (int k = 0; k < count; ++k) {
    const double theta = ((times[k] - start.high) - start.low) / h;
#pragma GCC unroll 16
    for (int i = 0; i < blocks; ++i) {
      Block value = load<Block>(coefficients + (degree * blocks + i) * width);
#pragma GCC unroll 16
      for (int p = degree - 1; p >= 0; --p) {
        value = fma(theta, value, load<Block>(coefficients + (p * blocks + i) * width));
      }
      store(states + (k * blocks + i) * width, value);
    }
  }
}

}  // namespace pendcore
