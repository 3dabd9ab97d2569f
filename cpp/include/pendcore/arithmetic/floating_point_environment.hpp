/// \file
/// Rounding to nearest, denormal numbers kept, while an object of this class lives.
///
/// A library built with -ffast-math switches the processor to flushing denormals to zero in every
/// thread that loads it, and a host program may have set another rounding. `simulate`, `resume`,
/// `Solution::at` and the bindings set the IEEE defaults and put back what they found.
///
/// x87 has a rounding of its own, which `fesetround` sets beside that of SSE. Long doubles round by
/// it: those of a method's coefficients, where the compiler left them to the program.
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

  /// Where a host left the defaults alone nothing is loaded, which takes long.
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
