#include "raster/threads/float_environment.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace softfocus {

// Control registers are written directly where that is known to suffice: a few cycles
// for fesetenv()'s hundred, and not every C library's resets flushing.

#if defined(__SSE2__)

DefaultFloatEnvironment::DefaultFloatEnvironment() : saved_(_mm_getcsr()) {
  constexpr std::uint32_t kDefault = 0x1F80;  // all exceptions masked, and nothing else
  _mm_setcsr(kDefault);
}
DefaultFloatEnvironment::~DefaultFloatEnvironment() { _mm_setcsr(saved_); }

#elif defined(__aarch64__)

DefaultFloatEnvironment::DefaultFloatEnvironment() {
  asm volatile("mrs %0, fpcr" : "=r"(saved_));
  asm volatile("msr fpcr, %0" : : "r"(std::uint64_t{0}));
}
DefaultFloatEnvironment::~DefaultFloatEnvironment() {
  asm volatile("msr fpcr, %0" : : "r"(saved_));
}

#else

DefaultFloatEnvironment::DefaultFloatEnvironment() {
  std::fegetenv(&saved_);
  std::fesetenv(FE_DFL_ENV);
}
DefaultFloatEnvironment::~DefaultFloatEnvironment() { std::fesetenv(&saved_); }

#endif

}  // namespace softfocus
