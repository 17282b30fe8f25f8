#include "tools/gl/driver/driver.h"

#include <array>

namespace softfocus {
namespace {

// llvmpipe fuses where the CPU can, and computes as with SSE4.1 where it cannot.
std::string_view profile_of_llvmpipe() {
#if defined(__x86_64__) || defined(__i386__)
  if (__builtin_cpu_supports("fma") == 0) return "llvmpipe-sse41";
#endif
  return "llvmpipe";
}

}  // namespace

std::span<const Driver> drivers() {
  static const std::array known{
      Driver{"llvmpipe", "Mesa's software renderer, compiled for this CPU", profile_of_llvmpipe(),
             "llvmpipe", ""},
      Driver{"llvmpipe-sse41", "the same held to SSE4.1, without fused multiply-add",
             "llvmpipe-sse41", "llvmpipe", "sse4.1"},
      Driver{.name = "softpipe",
             .summary = "Mesa's reference renderer, slow",
             .profile = "softpipe",
             .gallium_driver = "softpipe",
             .cpu_caps = "",
             .slow = true,
             .has_samples = false},
      Driver{"lavapipe", "Mesa's Vulkan driver for the CPU, under OpenGL by zink",
             profile_of_llvmpipe(), "zink", "", false, true},
      Driver{.name = "emulated",
             .summary = "the emulated GPU, which runs our GLSL without another driver",
             .profile = "ieee",
             .gallium_driver = "",
             .cpu_caps = "",
             .is_emulated = true,
             .has_samples = false},
      Driver{"gpu", "the first hardware GPU that EGL lists", "", "", ""},
  };
  return known;
}

const Driver* find_driver(std::string_view name) {
  for (const Driver& driver : drivers()) {
    if (driver.name == name) return &driver;
  }
  return nullptr;
}

}  // namespace softfocus
