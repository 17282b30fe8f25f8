#include "raster/numbers/profile.h"

#include <array>

namespace softfocus {
namespace {

constexpr Profile kIeee{
    .name = "ieee",
    .summary = "IEEE 754 throughout: stores round to nearest even, float weights, nothing fused",
};

constexpr Profile kD3d11{
    .name = "d3d11",
    .summary = "the Direct3D 11.3 specification: stores truncate, 8-bit bilinear weights",
    .half_store = HalfRounding::toward_zero,
    .bilinear_weights = BilinearWeights::fixed_8,
    .denormals = Denormals::flush,
};

// Both of Mesa 22.3's software rasterizers were measured: half stores truncate, and
// bilinear fetches of half textures are a + t (b - a), fused only where the CPU can.
constexpr Profile kLlvmpipe{
    .name = "llvmpipe",
    .summary = "Mesa 22.3 llvmpipe on a CPU with fused multiply-add",
    .half_store = HalfRounding::toward_zero,
    .lerp = Contraction::fused,
    .viewport = Contraction::fused,
    .interpolation = Contraction::fused,
    .attributes = AttributeSetup::planes_from_origin,
    .denormals = Denormals::flush,
    .guard_band = 1.0f,
};

constexpr Profile kLlvmpipeSse41{
    .name = "llvmpipe-sse41",
    .summary = "Mesa 22.3 llvmpipe held to SSE4.1: nothing fused",
    .half_store = HalfRounding::toward_zero,
    .attributes = AttributeSetup::planes_from_origin,
    .denormals = Denormals::flush,
    .guard_band = 1.0f,
};

constexpr Profile kSoftpipe{
    .name = "softpipe",
    .summary = "Mesa 22.3 softpipe: stores truncate, float weights, nothing fused",
    .half_store = HalfRounding::toward_zero,
    .attributes = AttributeSetup::planes_from_origin,
    .guard_band = 1.0f,
};

constexpr std::array kProfiles{kIeee, kD3d11, kLlvmpipe, kLlvmpipeSse41, kSoftpipe};

}  // namespace

std::span<const Profile> profiles() { return kProfiles; }

std::optional<Profile> find_profile(std::string_view name) {
  for (const Profile& profile : kProfiles) {
    if (profile.name == name) return profile;
  }
  return std::nullopt;
}

}  // namespace softfocus
