/// \file
/// A quantity of link 1 beside the same quantity of link 2.
///
/// The equations of a double pendulum read the same for both links once the other link has a name:
/// they are written for a pair, and `other` changes its places. For one trajectory the pair is a
/// pack of two, so that both links cost one instruction; for many, a pack is what each place holds.
#pragma once

#include "pendcore/arithmetic/pack.hpp"

namespace pendcore {

using Pair = Pack<2>;

/// (x_2, x_1)
PENDCORE_INLINE Pair other(const Pair& x) { return Pair{x[1], x[0]}; }

}  // namespace pendcore
