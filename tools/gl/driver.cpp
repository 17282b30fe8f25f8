#include "tools/gl/driver.h"

#include <array>

namespace softfocus {
namespace {

using Environment = std::vector<std::pair<const char*, const char*>>;

// What would change a software driver's arithmetic or its version is taken away, and
// no shader compiled for another CPU comes out of a cache.
Environment mesa(const char* gallium_driver, const char* cpu_caps) {
  return {{"LIBGL_ALWAYS_SOFTWARE", "1"},           {"GALLIUM_DRIVER", gallium_driver},
          {"GALLIUM_OVERRIDE_CPU_CAPS", cpu_caps},  {"LP_NATIVE_VECTOR_WIDTH", nullptr},
          {"MESA_LOADER_DRIVER_OVERRIDE", nullptr}, {"MESA_GL_VERSION_OVERRIDE", nullptr},
          {"MESA_GLSL_VERSION_OVERRIDE", nullptr},  {"MESA_SHADER_CACHE_DISABLE", "true"}};
}

// llvmpipe fuses where the CPU can, and computes as with SSE4.1 where it cannot.
std::string_view profile_of_llvmpipe() {
#if defined(__x86_64__) || defined(__i386__)
  if (__builtin_cpu_supports("fma") == 0) return "llvmpipe-sse41";
#endif
  return "llvmpipe";
}

}  // namespace

std::span<const Driver> drivers() {
  static const std::array kDrivers{
      Driver{"llvmpipe", "Mesa's software renderer, compiled for this CPU", profile_of_llvmpipe(),
             mesa("llvmpipe", nullptr), "llvmpipe"},
      Driver{"llvmpipe-sse41", "the same held to SSE4.1, without fused multiply-add",
             "llvmpipe-sse41", mesa("llvmpipe", "sse4.1"), "llvmpipe"},
      Driver{"softpipe", "Mesa's reference renderer, slow", "softpipe", mesa("softpipe", nullptr),
             "softpipe", true},
      Driver{"gpu", "the first hardware GPU that EGL lists", "", {}, ""},
  };
  return kDrivers;
}

const Driver* find_driver(std::string_view name) {
  for (const Driver& driver : drivers()) {
    if (driver.name == name) return &driver;
  }
  return nullptr;
}

}  // namespace softfocus
