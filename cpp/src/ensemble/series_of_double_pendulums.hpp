/// \file
/// Which kernels of series are compiled in a file of their own, with options of their own
/// (CMakeLists.txt): those of double pendulums, on every set of instructions that this build is
/// for. double_pendulum_lanes.cpp has them; all other files take them as `extern`.
#pragma once

#include "ensemble/series_lanes.hpp"

// A template that is compiled elsewhere must be named in full, once with `extern` and once without.
#define PENDCORE_EXPAND_KERNEL(maybe_extern, Form, set)                         \
  maybe_extern template ExpandKernel<Form<Pack<width_on(InstructionSet::set)>>, \
                                     width_on(InstructionSet::set)>             \
  expand_kernel_on<Form<Pack<width_on(InstructionSet::set)>>, InstructionSet::set>();
#if PENDCORE_CLONES
#define PENDCORE_EXPAND_KERNELS(maybe_extern, Form)     \
  PENDCORE_EXPAND_KERNEL(maybe_extern, Form, x86_64_v3) \
  PENDCORE_EXPAND_KERNEL(maybe_extern, Form, x86_64_v4)
#else
#define PENDCORE_EXPAND_KERNELS(maybe_extern, Form) \
  PENDCORE_EXPAND_KERNEL(maybe_extern, Form, x86_64_v3)
#endif
#define PENDCORE_SERIES_OF_DOUBLE_PENDULUMS(maybe_extern)         \
  PENDCORE_EXPAND_KERNELS(maybe_extern, BareDoublePendulumSeries) \
  PENDCORE_EXPAND_KERNELS(maybe_extern, LoadedDoublePendulumSeries)

namespace pendcore {

PENDCORE_SERIES_OF_DOUBLE_PENDULUMS(extern)

}  // namespace pendcore
