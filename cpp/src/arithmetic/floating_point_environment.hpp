/// \file
/// While an object of this class lives, its thread rounds to nearest and keeps denormal numbers.
///
/// A library built with -ffast-math switches the processor to flushing denormals to zero in every
/// thread that loads it, and a host program may have set another rounding. `simulate`, `resume`,
/// `Solution::at` and the bindings set the IEEE defaults and put back what they found.
#pragma once

#if defined(__x86_64__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace pendcore {

class FloatingPointEnvironment {
 public:
  FloatingPointEnvironment(const FloatingPointEnvironment&) = delete;
  FloatingPointEnvironment& operator=(const FloatingPointEnvironment&) = delete;
#if defined(__x86_64__)
  FloatingPointEnvironment() : found_(_mm_getcsr()) { _mm_setcsr(ieee_defaults); }
  ~FloatingPointEnvironment() { _mm_setcsr(found_); }

 private:
  static constexpr unsigned ieee_defaults = 0x1f80;  // nearest, no flushing, exceptions masked

  unsigned found_;
#else
  FloatingPointEnvironment() {
    std::fegetenv(&found_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatingPointEnvironment() { std::fesetenv(&found_); }

 private:
  std::fenv_t found_;
#endif
};

}  // namespace pendcore
