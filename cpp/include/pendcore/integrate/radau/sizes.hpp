/// \file
/// How many numbers a state has, and how a kernel works on them: in packs, or one after the other.
#pragma once

#include <array>
#include <vector>

#include "pendcore/arithmetic/pack.hpp"

namespace pendcore {

/// The compiler knows the number of links, so that a kernel has its state in registers. `Block` is
/// what one instruction works on: here all angles and rates.
template <int links>
struct SizesOf {
  static constexpr int n = links;
  static constexpr int state = 2 * links;
  static constexpr int size = state;

  using Block = Pack<state>;
  template <class Number, int count>
  using Memory = std::array<Number, static_cast<std::size_t>(count)>;
  template <int rows>
  using Rows = Memory<double, rows * state>;
  template <class Number>
  using Row = Memory<Number, links>;
  template <class Number>
  using Matrix = Memory<Number, links * links>;

  template <class Any>
  PENDCORE_INLINE static void allocate(Any& memory, int /*count*/) {
    memory = {};
  }
};

/// A state of any size, in memory.
struct SizesInMemory {
  int n;      ///< numbers in q
  int state;  ///< in q and qd
  int size;   ///< and in the quadratures

  using Block = double;
  template <int rows>
  using Rows = std::vector<double>;
  template <class Number>
  using Row = std::vector<Number>;
  template <class Number>
  using Matrix = std::vector<Number>;

  template <class Any>
  static void allocate(Any& memory, int count) {
    memory.assign(count, {});
  }
};

}  // namespace pendcore
