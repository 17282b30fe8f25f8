#pragma once
// The floating-point environment that results are defined in: round to nearest even,
// subnormals kept. A program can come with another. Linked with -ffast-math it flushes
// subnormals in every thread, which takes bits off halves below 2^-14 among others; it may
// also have called fesetround().

#include <cstdint>

#if !defined(__SSE2__) && !defined(__aarch64__)
#include <cfenv>
#endif

namespace softfocus {

/// Sets the default environment, and brings the calling thread's own back at the end.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment();
  ~DefaultFloatEnvironment();
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

 private:
#if defined(__SSE2__)
  std::uint32_t saved_;  // MXCSR
#elif defined(__aarch64__)
  std::uint64_t saved_;  // FPCR
#else
  std::fenv_t saved_;
#endif
};

}  // namespace softfocus
