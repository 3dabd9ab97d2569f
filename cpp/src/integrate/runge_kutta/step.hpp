/// \file
/// One step of an explicit Runge-Kutta method, from its table.
///
/// `attempt_step` is the kernel: the stages, the new state and its error norm, unrolled for the
/// table and the system at compile time. It does not allocate, and has no branches of its own.
/// runge_kutta_fixed.hpp clones it for each instruction set and hands it to the loop.
///
/// A system is a type with `Block` (a double or a pack), `blocks` (how many make a state) and
/// operator()(t, y, dydt) on blocks. Times, step sizes and errors are doubles. They are packs if
/// each lane of a block belongs to a trajectory of its own (ensemble/): then the kernel takes a
/// step of each of these trajectories, with the bits that it would have alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "arithmetic/power.hpp"
#include "arithmetic/row_of_links.hpp"
#include "integrate/loop/attempt.hpp"
#include "integrate/loop/step_control.hpp"
#include "integrate/runge_kutta/tableau.hpp"

namespace pendcore {

template <const auto& method, class System>
struct StepMemory {
  using Block = typename System::Block;
  static constexpr int blocks = System::blocks;
  static constexpr int stages = std::remove_cvref_t<decltype(method)>::stages;
  static constexpr int all_stages = std::remove_cvref_t<decltype(method)>::all_stages;
  static constexpr int degree = std::remove_cvref_t<decltype(method)>::degree;

  System system;
  Block y[blocks] = {};
  Block y_new[blocks] = {};
  Block k[all_stages][blocks] = {};
  Block rtol[blocks] = {};
  Block atol[blocks] = {};
};

/// start + h (sum of weights[j] k(j) over the first `count` stages); terms with weight zero are
/// left out. The last stage is known last. So it is added last, with its weight times h computed
/// before.
template <class Block, class Scale, class Weights, class Stage>
PENDCORE_INLINE Block advance(const Block& start, const Scale& h, const Weights& weights,
                              const Stage& k, int count) {
  int last = count - 1;
  while (last >= 0 && weights[last].is_zero()) --last;
  if (last < 0) return start;
  Block sum{};
  bool empty = true;
#pragma GCC unroll 16
  for (int j = 0; j < last; ++j) {
    if (weights[j].is_zero()) continue;
    const Block weight = Constants<Block>::of(weights[j].value);
    sum = empty ? Block(weight * k(j)) : fma(weight, k(j), sum);
    empty = false;
  }
  const Block known = empty ? start : fma(h, sum, start);
  return fma(h * weights[last].value, k(last), known);
}

/// The same sum, bit for bit, with weights that a loop reads.
template <class Block, class Scale, class Stage>
PENDCORE_INLINE Block advance(const Block& start, const Scale& h, const StageRow& row,
                              const Stage& k) {
  if (row.count == 0) return start;
  Block sum{};
  if (row.count > 1) sum = Constants<Block>::of(row.weight[0]) * k(row.stage[0]);
#pragma GCC unroll 1
  for (int i = 1; i < row.count - 1; ++i) {
    sum = fma(Constants<Block>::of(row.weight[i]), k(row.stage[i]), sum);
  }
  const int last = row.count - 1;
  const Block known = row.count > 1 ? fma(Constants<Block>::of(h), sum, start) : start;
  return fma(Constants<Block>::of(h * row.weight[last]), k(row.stage[last]), known);
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

/// The squares of the error over the components, in units of what the tolerances allow.
template <const auto& method, class Scale, class Block>
class SquaredErrors {
  using Method = std::remove_cvref_t<decltype(method)>;
  static constexpr bool has_second =
      std::ranges::any_of(method.d, [](const Fraction& weight) { return !weight.is_zero(); });

 public:
  /// Adds the squares of one block; `scale` is h divided by what is allowed.
  template <class Stage>
  PENDCORE_INLINE void add(const Block& y_new, const Block& scale, const Stage& k, bool is_first) {
    // Where no stage is at the new state, or no estimate contains that stage, nothing else shows
    // whether they are finite. So 0 is added, or NaN if they are not.
    Block start{};
    if constexpr (!method.first_same_as_last) start = y_new - y_new;
    if constexpr (method.first_same_as_last && method.info.error_order == 0) {
      start = k(Method::stages - 1) - k(Method::stages - 1);
    }
    const Block ratio = advance(start, scale, method.e, k, Method::stages);
    squares_ = is_first ? Block(ratio * ratio) : Block(squares_ + ratio * ratio);
    if constexpr (has_second) {
      const Block other = advance(Block{}, scale, method.d, k, Method::stages);
      others_ = is_first ? Block(other * other) : Block(others_ + other * other);
    }
  }
  PENDCORE_INLINE Scale mean(double share) const {
    const Scale sum = sum_of_numbers(squares_) * share;
    if constexpr (!has_second) {
      return sum;
    } else {
      const Scale others = sum_of_numbers(others_) * share;
      const Scale both = sum + 0.01 * others;
      constexpr double infinity = std::numeric_limits<double>::infinity();
      if constexpr (Lanes<Scale>::width == 1) {
        const Scale if_positive = both < infinity ? Scale(sum * (sum / both)) : both;
        return both > 0.0 ? if_positive : both;
      } else {
        // Nested selects are joined comparisons to GCC 12, which takes them apart (pack.hpp).
        const auto is_usual = is_less(Scale{}, both) & is_less(both, broadcast<Scale>(infinity));
        return is_usual ? Scale(sum * (sum / both)) : both;
      }
    }
  }

 private:
  Block squares_{};
  std::conditional_t<has_second, Block, char> others_{};  // never read without a second method
};

/// Whether the stages are compiled one after the other, each with its own copy of the right-hand
/// side, which is the fastest step. Otherwise they are a loop around one copy, which compiles in a
/// fifth of the time; with a long right-hand side it is as fast.
template <const auto& method, class System>
constexpr bool is_written_out = [] {
  if constexpr (requires { System::is_short; }) {
    return System::is_short || (method.written_out && !System::is_long);
  }
  return method.written_out;
}();

/// Computes stages first .. end - 1 into k, which has the stages before them; z becomes the state
/// of the last one.
template <const auto& method, int first, int end, class System, class Scale, class Block,
          int blocks>
PENDCORE_INLINE void evaluate_stages(const System& system, const Scale& t, const Scale& h,
                                     const Block (&y)[blocks], Block (*k)[blocks],
                                     Block (&z)[blocks]) {
  if constexpr (is_written_out<method, System>) {
#pragma GCC unroll 16
    for (int s = first; s < end; ++s) {
#pragma GCC unroll 16
      for (int i = 0; i < blocks; ++i) z[i] = advance(y[i], h, method.a[s], StageBlock(k, i), s);
      system(t + method.c[s].value * h, z, k[s]);
    }
  } else {
    static constexpr auto rows = rows_of(method);
#pragma GCC unroll 1
    for (int s = first; s < end; ++s) {
#pragma GCC unroll 16
      for (int i = 0; i < blocks; ++i) z[i] = advance(y[i], h, rows[s], StageBlock(k, i));
      system(t + rows[s].node * h, z, k[s]);
    }
  }
}

/// Tries a step of size h at time t: computes the stages, the new state, its error and the factor
/// for the next step.
template <const auto& method, class System, class Scale>
PENDCORE_INLINE ErrorAndFactor<Scale> judged_step(StepMemory<method, System>* memory,
                                                  const Scale& t, const Scale& h,
                                                  const Scale& gain) {
  using Memory = StepMemory<method, System>;
  using Block = typename Memory::Block;
  constexpr int blocks = Memory::blocks;
  constexpr int stages = Memory::stages;

  // Local copies stay in registers, and memory is written once, at the end. The stages of a loop
  // stay in memory.
  using LocalSystem =
      std::conditional_t<std::is_same_v<Scale, double>, const System, const System&>;
  LocalSystem system = memory->system;
  Block y[blocks];
  Block z[blocks];
  constexpr bool in_registers = is_written_out<method, System>;
  Block local[in_registers ? stages : 1][blocks];
  Block(*const k)[blocks] = in_registers ? local : memory->k;
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    y[i] = memory->y[i];
    k[0][i] = memory->k[0][i];
  }
  evaluate_stages<method, 1, stages>(system, t, h, y, k, z);
  if constexpr (!method.first_same_as_last) {
#pragma GCC unroll 16
    for (int i = 0; i < blocks; ++i) z[i] = advance(y[i], h, method.b, StageBlock(k, i), stages);
  }

  // The scales only wait for y_new, so their division is done before the last stage is.
  SquaredErrors<method, Scale, Block> squares;
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    const Block size = larger(absolute(y[i]), absolute(z[i]));
    const Block scale = h / fma(memory->rtol[i], size, memory->atol[i]);
    squares.add(z[i], scale, StageBlock(k, i), i == 0);
  }
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    memory->y_new[i] = z[i];
    if constexpr (in_registers) {
#pragma GCC unroll 16
      for (int s = 1; s < stages; ++s) memory->k[s][i] = k[s][i];
    }
  }
  const Scale squared_error = squares.mean(1.0 / (blocks * count_of_numbers<Block>));
  return {squared_error, scaled_power(squared_error, -0.5 * exponent(method.info), gain)};
}

/// The same for one trajectory, as Stepper::attempt says.
template <const auto& method, class System>
PENDCORE_INLINE Attempt attempt_step(StepMemory<method, System>* memory, double t, double h,
                                     double gain) {
  return {judged_step(memory, t, h, gain)};
}

/// The stages of the attempted step, from time t, that the dense output alone asks for.
template <const auto& method, class System>
PENDCORE_INLINE void dense_stages_of_step(StepMemory<method, System>* memory, double t, double h) {
  using Memory = StepMemory<method, System>;
  if constexpr (Memory::all_stages > Memory::stages) {
    typename Memory::Block z[Memory::blocks];
    evaluate_stages<method, Memory::stages, Memory::all_stages>(memory->system, t, h, memory->y,
                                                                memory->k, z);
  }
}

/// The coefficients of theta, theta^2, ... of the dense output of one block of the state, from its
/// stages.
template <const auto& method, class Scale, class Stage, class Block>
PENDCORE_INLINE void interpolant_of_block(const Scale& h, const Stage& k, Block* powers) {
  using Method = std::remove_cvref_t<decltype(method)>;
  Block functions[Method::degree];
#pragma GCC unroll 16
  for (int i = 0; i < Method::degree; ++i) {
    Block sum{};
#pragma GCC unroll 16
    for (int s = 0; s < Method::all_stages; ++s) {
      if (method.interpolant[i][s].is_zero()) continue;
      sum = fma(Constants<Block>::of(method.interpolant[i][s].value), k(s), sum);
    }
    functions[i] = h * sum;
  }
#pragma GCC unroll 16
  for (int p = 0; p < Method::degree; ++p) {
    powers[p] = Block{};
    bool empty = true;
#pragma GCC unroll 16
    for (int i = 0; i < Method::degree; ++i) {
      const int weight = method.basis[i][p];
      if (weight == 0) continue;
      const bool is_alone = empty && weight == 1;
      powers[p] = is_alone ? functions[i]
                           : fma(Constants<Block>::of(static_cast<double>(weight)), functions[i],
                                 powers[p]);
      empty = false;
    }
  }
}

/// Computes coefficient[p] of theta^p for p = 1 .. degree, and coefficient[0] = y: the dense output
/// of a step from y with the stages k, (degree + 1) rows of a state each. It works for any system.
template <const auto& method, class Block, int blocks>
PENDCORE_INLINE void interpolant_of_step(const Block* y, const Block (*k)[blocks], double h,
                                         double* coefficients) {
  constexpr int degree = std::remove_cvref_t<decltype(method)>::degree;
  constexpr int width = Lanes<Block>::width;
#pragma GCC unroll 16
  for (int i = 0; i < blocks; ++i) {
    store(coefficients + i * width, y[i]);
    Block powers[degree];
    interpolant_of_block<method>(h, StageBlock(k, i), powers);
#pragma GCC unroll 16
    for (int p = 0; p < degree; ++p) {
      store(coefficients + ((p + 1) * blocks + i) * width, powers[p]);
    }
  }
}

/// |h| |k_last - k_before| / |y_last - y_before|, both stages at the end of the step: an estimate
/// of h |lambda| (Hairer and Wanner II, IV.2). `block(i)` returns y, y_new and the stages of block
/// i.
template <const auto& method, class Scale, class Blocks>
PENDCORE_INLINE Scale stiffness_of_step(const Scale& h, int blocks, const Blocks& block) {
  using Method = std::remove_cvref_t<decltype(method)>;
  constexpr int stages = Method::stages;
  static_assert(method.first_same_as_last && stages >= 3 && method.c[stages - 2].value == 1.0,
                "the test for stiffness needs two stages at the end of the step");
  Scale rates{};
  Scale states{};
  for (int i = 0; i < blocks; ++i) {
    const auto& [y, y_new, k] = block(i);
    const auto before = advance(y, h, method.a[stages - 2], k, stages - 2);
    const auto dk = k(stages - 1) - k(stages - 2);
    const auto dy = y_new - before;
    rates += sum_of_numbers(dk * dk);
    states += sum_of_numbers(dy * dy);
  }
  if constexpr (std::is_same_v<Scale, double>) {
    return states > 0.0 ? std::abs(h) * std::sqrt(rates / states) : 0.0;
  } else {
    Scale stiffness{};
    for (int i = 0; i < Lanes<Scale>::width; ++i) {
      if (states[i] > 0.0) stiffness[i] = std::abs(h[i]) * std::sqrt(rates[i] / states[i]);
    }
    return stiffness;
  }
}

}  // namespace pendcore
