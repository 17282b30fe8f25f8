#pragma once
// The vector units that kernels are compiled for. One is chosen at run time. All give the
// same bits.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

// AVX only on 64-bit x86, and not with mingw-w64's g++,
// which spills 32-byte vectors to a stack that is aligned to 16 (GCC bug 54412).
#if !defined(__x86_64__) || defined(_WIN32)
#undef SOFTFOCUS_ONLY_LANES
#define SOFTFOCUS_ONLY_LANES 4
#endif

#ifdef SOFTFOCUS_ONLY_LANES
#define SOFTFOCUS_HAS_LANES(count) (SOFTFOCUS_ONLY_LANES == (count))
#else
#define SOFTFOCUS_HAS_LANES(count) 1
#endif

namespace softfocus {

enum class Isa : std::uint8_t {
  scalar,    ///< the scalar form of what has one; kernels without one in four lanes
  baseline,  ///< 4 lanes, in what every CPU of the build has: SSE2, NEON on 64-bit Arm
  avx2,      ///< 8 lanes: AVX2, FMA and F16C
  avx512,    ///< 16 lanes: AVX-512 F, BW, DQ and VL beside those
};

/// The units of this CPU, `scalar` first, then by width.
std::span<const Isa> available_isas();

/// The last of them.
Isa widest_isa();

/// 32-bit numbers in a vector of a unit, and in the widest of all. Needs an isa with vectors.
constexpr int lanes_of([[maybe_unused]] Isa isa) {
#ifdef SOFTFOCUS_ONLY_LANES
  return SOFTFOCUS_ONLY_LANES;  // `scalar` takes its kernels too where they do the scalar's work
#else
  return isa == Isa::avx512 ? 16 : isa == Isa::avx2 ? 8 : 4;
#endif
}
inline constexpr int kMostLanes = 16;

/// "scalar", "baseline", "avx2", "avx512".
std::string_view isa_name(Isa isa);

/// The available unit of that name; "neon" is another name of 64-bit Arm's baseline.
std::optional<Isa> find_isa(std::string_view name);

}  // namespace softfocus
