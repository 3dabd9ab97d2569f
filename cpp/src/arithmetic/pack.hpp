/// \file
/// A pack: a few doubles that one processor instruction works on together.
///
/// The same operation in the same order acts on every lane, and a product and a sum are fused only
/// where the source says `fma`. A lane therefore holds the same bits whatever the width of the
/// pack, whatever the instruction set, alone or beside others. A plain double is a pack of one.
#pragma once

#include <bit>
#include <type_traits>

#include "arithmetic/instruction_set.hpp"

// Only inlined functions pass packs to each other, so that the calling convention does not matter;
// pendcore_fma, which is not inlined, takes packs of two, which fit into a register everywhere.
#pragma GCC diagnostic ignored "-Wpsabi"

// In clones for processors that have the instruction, fma() calls it by name. GCC finds it in a
// loop over the lanes, too, but so kernels compile in 0.55 to 0.8 of the time (lanes of eight: 13 s
// of 23), as packs stay in registers from the beginning. Newer versions of GCC were not tried.
// A source that is faster by the loop says so before it includes this.
#ifdef PENDCORE_NAMES_FMA
#elif PENDCORE_CLONES && defined(__OPTIMIZE__) && !defined(__SSE4_1__) && __GNUC__ == 12 && \
    !defined(__clang__)
#define PENDCORE_NAMES_FMA 1
// It makes the names known.
#pragma GCC push_options
#pragma GCC target("arch=x86-64-v4")
#pragma GCC pop_options
#else
#define PENDCORE_NAMES_FMA 0
#endif

namespace pendcore {

/// The number of lanes of a `Real`, and the integers of the same shape. GCC takes the size of a
/// vector only as a literal, so there is one specialisation for each width.
template <class Real>
struct Lanes {
  static constexpr int width = 1;
  using Number = double;  ///< what a lane holds
  using Integers = long long;
};

namespace pack_detail {
template <int width>
struct Vector;
template <>
struct Vector<2> {
  typedef double Reals __attribute__((vector_size(16)));
  typedef long long Integers __attribute__((vector_size(16)));
};
template <>
struct Vector<4> {
  typedef double Reals __attribute__((vector_size(32)));
  typedef long long Integers __attribute__((vector_size(32)));
};
template <>
struct Vector<8> {
  typedef double Reals __attribute__((vector_size(64)));
  typedef long long Integers __attribute__((vector_size(64)));
};
template <int pack_width>
struct LanesOf : Vector<pack_width> {
  static constexpr int width = pack_width;
  using Number = double;
};
}  // namespace pack_detail

template <int width>
using Pack = typename pack_detail::Vector<width>::Reals;

/// Whether something holds: for one number, or in each lane, where all bits are set if it does.
template <class Real>
using Condition =
    std::conditional_t<std::is_same_v<Real, double>, bool, typename Lanes<Real>::Integers>;

template <>
struct Lanes<Pack<2>> : pack_detail::LanesOf<2> {};
template <>
struct Lanes<Pack<4>> : pack_detail::LanesOf<4> {};
template <>
struct Lanes<Pack<8>> : pack_detail::LanesOf<8> {};

/// The same number in every lane.
template <class Real>
PENDCORE_INLINE Real broadcast(double x) {
  if constexpr (Lanes<Real>::width == 1) {
    return x;
  } else if constexpr (Lanes<Real>::width == 8) {
    Real all;  // in fma(), GCC 12 makes eight masked instructions of x - Real{}
    for (int i = 0; i < Lanes<Real>::width; ++i) all[i] = x;
    return all;
  } else {
    return x - Real{};  // x - 0 is x, minus zero included
  }
}

template <class Real>
PENDCORE_INLINE double lane(const Real& x, int index) {
  if constexpr (Lanes<Real>::width == 1) {
    return x;
  } else {
    return x[index];
  }
}

template <class Real>
PENDCORE_INLINE void set_lane(Real& x, int index, double value) {
  if constexpr (Lanes<Real>::width == 1) {
    x = value;
  } else {
    x[index] = value;
  }
}

PENDCORE_INLINE double value_of(double x) { return x; }

/// Whether all its numbers are zero.
template <class Real>
bool is_zero(const Real& x) {
  for (int i = 0; i < Lanes<Real>::width; ++i) {
    if (lane(x, i) != 0.0) return false;
  }
  return true;
}

/// Loads a pack from consecutive numbers in memory, or stores it; any alignment. A pack that is
/// loaded soon is best stored as that pack: a processor waits until numbers that were stored one by
/// one, or as parts of other packs, are in memory.
template <class Real>
PENDCORE_INLINE Real load(const double* from) {
  Real x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
template <class Real>
PENDCORE_INLINE void store(double* to, const Real& x) {
  __builtin_memcpy(to, &x, sizeof x);
}

/// Joins two packs into one; low_half and high_half take a half of a pack.
PENDCORE_INLINE Pack<4> joined(const Pack<2>& low, const Pack<2>& high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3);
}
PENDCORE_INLINE Pack<8> joined(const Pack<4>& low, const Pack<4>& high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
PENDCORE_INLINE Pack<2> low_half(const Pack<4>& x) { return __builtin_shufflevector(x, x, 0, 1); }
PENDCORE_INLINE Pack<2> high_half(const Pack<4>& x) { return __builtin_shufflevector(x, x, 2, 3); }
PENDCORE_INLINE Pack<4> low_half(const Pack<8>& x) {
  return __builtin_shufflevector(x, x, 0, 1, 2, 3);
}
PENDCORE_INLINE Pack<4> high_half(const Pack<8>& x) {
  return __builtin_shufflevector(x, x, 4, 5, 6, 7);
}

#if defined(__wasm__) || PENDCORE_NAMES_FMA
/// In WebAssembly, calls of this function are what the loader replaces by an instruction, in an
/// engine that has one which rounds once (docs/how_to/webassembly.md). Elsewhere it is for
/// processors without the instruction.
extern "C" [[gnu::const]] Pack<2> pendcore_fma(Pack<2> a, Pack<2> b, Pack<2> c) noexcept;
#endif

#if PENDCORE_NAMES_FMA
/// Whether the function into which this is inlined is a clone for x86-64-v3 or more. GCC computes
/// the comparison, an instruction of SSE 4.1, where that may be used, and leaves it alone
/// elsewhere. Without noexcept a call that nothing uses could stay, as it might throw.
PENDCORE_INLINE bool is_in_clone_with_fma() noexcept {
  using Integers = pack_detail::Vector<2>::Integers;
  return __builtin_constant_p(__builtin_ia32_pcmpeqq(Integers{}, Integers{})[0]);
}
/// Whether it is a clone for x86-64-v4, by an exchange of AVX-512 in the same way.
PENDCORE_INLINE bool is_in_clone_with_wide_fma() noexcept {
  constexpr unsigned char every_lane = 0xff;
  return __builtin_constant_p(
      __builtin_ia32_shufpd512_mask(Pack<8>{}, Pack<8>{}, 0, Pack<8>{}, every_lane)[0]);
}
#endif

/// fma() as a loop over the lanes, in which GCC finds the instruction. It compiles longer, and
/// steps of a double pendulum's series take 2 to 4 % less by it.
template <class Real>
PENDCORE_INLINE Real fma_lane_by_lane(const Real& a, const Real& b, const Real& c) {
  Real result = c;
  for (int i = 0; i < Lanes<Real>::width; ++i) {
    set_lane(result, i, __builtin_fma(lane(a, i), lane(b, i), lane(c, i)));
  }
  return result;
}

/// a b + c, rounded once. It is correctly rounded by definition, hence the same on every processor;
/// one without such an instruction has it from the C library, or in WebAssembly from
/// emulated_fma.hpp.
template <class Real>
PENDCORE_INLINE Real fma(const Real& a, const Real& b, const Real& c) noexcept {
  constexpr int width = Lanes<Real>::width;
#if defined(__wasm__)
  Real result = c;
  for (int i = 0; i < width; i += 2) {
    const int second = width == 1 ? i : i + 1;
    const auto two = [&](const Real& x) { return Pack<2>{lane(x, i), lane(x, second)}; };
    const Pack<2> fused = pendcore_fma(two(a), two(b), two(c));
    set_lane(result, i, fused[0]);
    if constexpr (width > 1) set_lane(result, second, fused[1]);
  }
  return result;
#else
  if constexpr (width == 1) {
    return __builtin_fma(a, b, c);
  } else {
#if PENDCORE_NAMES_FMA
    if constexpr (width == 8) {
      constexpr unsigned char every_lane = 0xff;
      constexpr int rounds_as_usual = 4;
      if (is_in_clone_with_wide_fma()) {
        return __builtin_ia32_vfmaddpd512_mask(a, b, c, every_lane, rounds_as_usual);
      }
      return joined(fma(low_half(a), low_half(b), low_half(c)),
                    fma(high_half(a), high_half(b), high_half(c)));
    } else if constexpr (width == 4) {
      if (is_in_clone_with_fma()) return __builtin_ia32_vfmaddpd256(a, b, c);
      return joined(pendcore_fma(low_half(a), low_half(b), low_half(c)),
                    pendcore_fma(high_half(a), high_half(b), high_half(c)));
    } else {
      return is_in_clone_with_fma() ? __builtin_ia32_vfmaddpd(a, b, c) : pendcore_fma(a, b, c);
    }
#else
    return fma_lane_by_lane(a, b, c);
#endif
  }
#endif
}
template <class Real>
  requires(Lanes<Real>::width > 1)
PENDCORE_INLINE Real fma(double a, const Real& b, const Real& c) {
  return fma(broadcast<Real>(a), b, c);
}

template <class Real>
PENDCORE_INLINE Real absolute(const Real& x) {
  if constexpr (Lanes<Real>::width == 1) {
    return __builtin_fabs(x);
  } else {
    using Integers = typename Lanes<Real>::Integers;
    constexpr long long all_but_sign = 0x7fffffffffffffff;
    return std::bit_cast<Real>(std::bit_cast<Integers>(x) & all_but_sign);
  }
}

/// A comparison in every lane: integers whose bits are all set where it holds. What < and <= of
/// doubles return must not be joined with each other by & and |: GCC 12 takes such results apart,
/// number by number, if packs have eight of them.
template <class Real>
PENDCORE_INLINE Condition<Real> is_less(const Real& a, const Real& b) {
  if constexpr (std::is_same_v<Real, double>) {
    return a < b;
  } else {
    using Integers = typename Lanes<Real>::Integers;
    return std::bit_cast<Integers>(a < b ? std::bit_cast<Real>(Integers{} - 1) : Real{});
  }
}
template <class Real>
PENDCORE_INLINE Condition<Real> is_at_most(const Real& a, const Real& b) {
  if constexpr (std::is_same_v<Real, double>) {
    return a <= b;
  } else {
    using Integers = typename Lanes<Real>::Integers;
    return std::bit_cast<Integers>(a <= b ? std::bit_cast<Real>(Integers{} - 1) : Real{});
  }
}

/// Whether something holds in any lane.
template <class AnyCondition>
PENDCORE_INLINE bool holds_somewhere(const AnyCondition& x) {
  if constexpr (std::is_same_v<AnyCondition, bool>) {
    return x;
  } else {
    long long bits = 0;
    for (std::size_t i = 0; i < sizeof(x) / sizeof(x[0]); ++i) bits |= x[i];
    return bits != 0;
  }
}

/// The larger number in every lane; `b` where either is NaN.
template <class Real>
PENDCORE_INLINE Real larger(const Real& a, const Real& b) {
  return a > b ? a : b;
}
/// The same, but `a` where either is NaN, as std::max(a, b) has it.
template <class Real>
PENDCORE_INLINE Real larger_or_first(const Real& a, const Real& b) {
  return a < b ? b : a;
}

/// The sum of the lanes, from the first to the last.
template <class Real>
PENDCORE_INLINE double sum_of_lanes(const Real& x) {
  double sum = lane(x, 0);
  for (int i = 1; i < Lanes<Real>::width; ++i) sum += lane(x, i);
  return sum;
}
/// The sum of a pack. Wide packs add their halves first, which shortens the chain of dependent
/// operations.
template <class Real>
PENDCORE_INLINE double sum_by_halves(const Real& x) {
  if constexpr (Lanes<Real>::width > 2) {
    return sum_by_halves(low_half(x) + high_half(x));
  } else {
    return sum_of_lanes(x);
  }
}

}  // namespace pendcore
