#include "arithmetic/pack.hpp"

#if PENDCORE_NAMES_FMA
namespace pendcore {

Pack<2> pendcore_fma(Pack<2> a, Pack<2> b, Pack<2> c) noexcept {
  return Pack<2>{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
}

}  // namespace pendcore
#endif
