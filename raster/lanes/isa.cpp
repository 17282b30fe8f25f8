#include "raster/lanes/isa.h"

#include <array>
#include <vector>

#if SOFTFOCUS_HAS_LANES(8) || SOFTFOCUS_HAS_LANES(16)
#include <cpuid.h>
#define SOFTFOCUS_HAS_AVX
#endif

namespace softfocus {
namespace {

constexpr std::array<std::string_view, 4> kNames{"scalar", "baseline", "avx2", "avx512"};

#ifdef SOFTFOCUS_HAS_AVX
// clang 14 cannot be asked for F16C by name.
bool has_f16c() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & bit_F16C) != 0;
}
#endif

std::vector<Isa> find_available() {
  std::vector<Isa> found{Isa::scalar};
  if (SOFTFOCUS_HAS_LANES(4)) found.push_back(Isa::baseline);
#ifdef SOFTFOCUS_HAS_AVX
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !has_f16c())
    return found;
  if (SOFTFOCUS_HAS_LANES(8)) found.push_back(Isa::avx2);
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (SOFTFOCUS_HAS_LANES(16) && avx512) found.push_back(Isa::avx512);
#endif
  return found;
}

}  // namespace

std::span<const Isa> available_isas() {
  static const std::vector<Isa> available = find_available();
  return available;
}

Isa widest_isa() { return available_isas().back(); }

std::string_view isa_name(Isa isa) { return kNames[static_cast<std::size_t>(isa)]; }

std::optional<Isa> find_isa(std::string_view name) {
#ifdef __aarch64__
  if (name == "neon") return Isa::baseline;
#endif
  for (const Isa isa : available_isas()) {
    if (isa_name(isa) == name) return isa;
  }
  return std::nullopt;
}

}  // namespace softfocus
