/// \file
/// How many numbers a state has, and how a kernel works on them: in packs, or one after the other.
#pragma once

#include <array>
#include <vector>

#include "arithmetic/pack.hpp"

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
  /// Stores what angle(i) and rate(i) are for each link, as a pack (pack.hpp says why).
  template <class Angle, class Rate>
  PENDCORE_INLINE static void store_state(double* to, int /*n*/, const Angle& angle,
                                          const Rate& rate) {
    Block both;
#pragma GCC unroll 2
    for (int i = 0; i < n; ++i) {
      set_lane(both, i, angle(i));
      set_lane(both, n + i, rate(i));
    }
    store(to, both);
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
  template <class Angle, class Rate>
  PENDCORE_INLINE static void store_state(double* to, int n, const Angle& angle, const Rate& rate) {
    for (int i = 0; i < n; ++i) to[i] = angle(i);
    for (int i = 0; i < n; ++i) to[n + i] = rate(i);
  }
};

}  // namespace pendcore
