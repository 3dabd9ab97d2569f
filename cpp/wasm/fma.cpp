#include "arithmetic/emulated_fma.hpp"

/// Its calls stay calls: the loader finds them by this function's number.
extern "C" [[clang::export_name("pendcore_fma"), gnu::noinline]] pendcore::Pack<2> pendcore_fma(
    pendcore::Pack<2> a, pendcore::Pack<2> b, pendcore::Pack<2> c) noexcept {
  return pendcore::emulated_fma(a, b, c);
}
