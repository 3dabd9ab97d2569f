/// \file
/// The same operations at the width that the processor offers, chosen at run time.
///
/// A kernel is an ordinary always-inline function. `fastest<kernel>()` returns one of its clones:
/// compiled for any x86-64 processor, for x86-64-v3 (AVX2 and fused multiply-add, from 2013 on) or
/// for x86-64-v4 (AVX-512). All clones come from one source with contraction off, so that they
/// return the same bits and differ only in speed. No file is compiled with -march: the linker would
/// merge inline functions that such files share, and keep whichever copy it meets first.
///
/// The environment variable PENDCORE_INSTRUCTION_SET (baseline, x86-64-v3, x86-64-v4) chooses a
/// lower instruction set; the tests compare them in this way.
#pragma once

#define PENDCORE_INLINE [[gnu::always_inline]] inline
/// For long parts of kernels with several callers. A module that is sent to browsers has them once.
#ifdef PENDCORE_SMALL
#define PENDCORE_INLINE_UNLESS_SMALL [[gnu::noinline]] inline
#else
#define PENDCORE_INLINE_UNLESS_SMALL PENDCORE_INLINE
#endif

// A build with -march for AVX2 or more is for that processor alone and needs no clones.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__) && \
    !defined(PENDCORE_BASELINE_ONLY)
#define PENDCORE_CLONES 1
#else
#define PENDCORE_CLONES 0
#endif

namespace pendcore {

enum class InstructionSet { baseline, x86_64_v3, x86_64_v4 };

/// The highest instruction set of this processor, or the lower one that the environment asks for.
/// Throws std::invalid_argument if the environment names none of the three.
InstructionSet instruction_set();

/// Its name: "baseline", "x86-64-v3" or "x86-64-v4".
const char* name(InstructionSet set);

template <auto kernel>
struct Clones;

template <class Result, class... Arguments, Result (*kernel)(Arguments...)>
struct Clones<kernel> {
  using Function = Result (*)(Arguments...);

  [[gnu::flatten]] static Result baseline(Arguments... arguments) { return kernel(arguments...); }
#if PENDCORE_CLONES
  [[gnu::flatten, gnu::target("arch=x86-64-v3")]] static Result v3(Arguments... arguments) {
    return kernel(arguments...);
  }
  [[gnu::flatten, gnu::target("arch=x86-64-v4")]] static Result v4(Arguments... arguments) {
    return kernel(arguments...);
  }
#endif
};

/// From which instruction set to which a kernel has clones.
struct Sets {
  InstructionSet least, best;
};

/// The lowest instruction set for which a kernel is compiled that has the same bits as a general
/// one and is only faster: a processor from before 2013 runs the general one.
constexpr InstructionSet least_of_special_kernels =
    PENDCORE_CLONES != 0 ? InstructionSet::x86_64_v3 : InstructionSet::baseline;

// This is the table of clones. Lanes are not in it: they have a kernel of their own for the width
// of each set's registers, only(). docs/background/one_equation.md has the figures.

/// For kernels that gain nothing by x86-64-v4: those of one number or two at a time, of series, of
/// dense output and its defect.
inline constexpr Sets usual_sets{InstructionSet::baseline, InstructionSet::x86_64_v3};
/// For chains in memory, which are computed four numbers at a time, and the series of a bare double
/// pendulum.
inline constexpr Sets wide_sets{InstructionSet::baseline, InstructionSet::x86_64_v4};
/// For kernels that are only faster than a general one, of the first kind and of the second.
inline constexpr Sets special_sets{least_of_special_kernels, InstructionSet::x86_64_v3};
inline constexpr Sets wide_special_sets{least_of_special_kernels, InstructionSet::x86_64_v4};

/// The clone of `kernel` for this processor, which has at least the lowest of the sets.
template <auto kernel, Sets sets = usual_sets>
typename Clones<kernel>::Function fastest() {
#if PENDCORE_CLONES
  const InstructionSet offered = instruction_set();
  if constexpr (sets.best == InstructionSet::x86_64_v4) {
    if (offered == InstructionSet::x86_64_v4) return Clones<kernel>::v4;
  }
  if constexpr (sets.least == InstructionSet::baseline) {
    if (offered == InstructionSet::baseline) return Clones<kernel>::baseline;
  }
  return Clones<kernel>::v3;
#else
  return Clones<kernel>::baseline;
#endif
}

/// Calls that clone.
template <auto kernel, Sets sets = usual_sets, class... Arguments>
auto on_this_processor(Arguments&&... arguments) {
  static const auto clone = fastest<kernel, sets>();
  return clone(static_cast<Arguments&&>(arguments)...);
}

/// The clone of `kernel` for one instruction set, if each set has a kernel of its own. A build
/// without clones has the one that it is for.
template <auto kernel, InstructionSet set>
typename Clones<kernel>::Function only() {
#if PENDCORE_CLONES
  if constexpr (set == InstructionSet::x86_64_v4) {
    return Clones<kernel>::v4;
  } else {
    return Clones<kernel>::v3;
  }
#else
  return Clones<kernel>::baseline;
#endif
}

/// Whether special kernels are compiled for scenes with effects and for compensated steps, too. A
/// module that is sent to browsers does without them: they are a fifth of its size.
#ifdef PENDCORE_SMALL
constexpr bool has_special_kernels_of_rare_runs = false;
#else
constexpr bool has_special_kernels_of_rare_runs = true;
#endif

}  // namespace pendcore
