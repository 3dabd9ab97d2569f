/// \file
/// While an object of this class lives, its thread rounds to nearest and keeps denormal numbers.
///
/// A library built with -ffast-math switches the processor to flushing denormals to zero in every
/// thread that loads it, and a host program may have set another rounding. `simulate`, `resume`,
/// `Solution::at` and the bindings set the IEEE defaults and put back what they found.
///
/// The x87 unit has its own rounding mode, which `fesetround` sets beside the mode of SSE. It
/// applies to long doubles: the coefficients of a method, where the compiler left their evaluation
/// to the program.
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
  FloatingPointEnvironment() : found_(_mm_getcsr()) {
    _mm_setcsr(ieee_defaults);
    asm volatile("fnstcw %0" : "=m"(found_x87_));
    set_x87(ieee_defaults_x87);
  }
  ~FloatingPointEnvironment() {
    _mm_setcsr(found_);
    set_x87(found_x87_);
  }

 private:
  static constexpr unsigned ieee_defaults = 0x1f80;  // nearest, no flushing, exceptions masked
  static constexpr unsigned short ieee_defaults_x87 = 0x037f;  // nearest, 64 bits, masked

  /// Loads nothing where the host left the defaults unchanged, because loading takes long.
  void set_x87(unsigned short control) const {
    if (found_x87_ != ieee_defaults_x87) asm volatile("fldcw %0" : : "m"(control));
  }

  unsigned found_;
  unsigned short found_x87_;
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
