#include "raster/numbers/profile.h"

#include <array>

namespace softfocus {
namespace {

Profile ieee() {
  return {
      .name = "ieee",
      .summary = "IEEE 754 throughout: stores round to nearest even, float weights, nothing fused"};
}

Profile d3d11() {
  return {.name = "d3d11",
          .summary = "the Direct3D 11.3 specification: stores truncate, 8-bit bilinear weights",
          .half_store = HalfRounding::toward_zero,
          .denormals = Denormals::flush,
          .bilinear_weights = BilinearWeights::fixed_8,
          .bilinear_filter = BilinearFilter::integers};
}

// Mesa's software rasterizers were measured; docs/specification.md has every operation.
Profile llvmpipe() {
  return {.name = "llvmpipe",
          .summary = "Mesa 22.3 llvmpipe on a CPU with fused multiply-add",
          .half_store = HalfRounding::toward_zero,
          .unorm_store = UnormRounding::nearest_even,
          .denormals = Denormals::flush,
          .texture_unit = TextureUnit::llvmpipe,
          .lerp = Contraction::fused,
          .viewport = Contraction::fused,
          .guard_band = 1.0f,
          .clipping = Clipping::mesa,
          .attributes = AttributeSetup::planes_from_origin,
          .interpolation = Contraction::fused};
}

Profile llvmpipe_sse41() {
  Profile profile = llvmpipe();
  profile.name = "llvmpipe-sse41";
  profile.summary = "Mesa 22.3 llvmpipe held to SSE4.1: nothing fused";
  profile.lerp = Contraction::unfused;
  profile.viewport = Contraction::unfused;
  profile.interpolation = Contraction::unfused;
  return profile;
}

Profile softpipe() {
  return {.name = "softpipe",
          .summary = "Mesa 22.3 softpipe: float spans, float textures, nothing fused",
          .half_store = HalfRounding::toward_zero,
          .unorm_store = UnormRounding::nearest_even,
          .texture_unit = TextureUnit::softpipe,
          .guard_band = 1.0f,
          .clipping = Clipping::mesa,
          .coverage = Coverage::scanlines,
          .attributes = AttributeSetup::planes_by_quad};
}

}  // namespace

std::span<const Profile> profiles() {
  static const std::array kProfiles{ieee(), d3d11(), llvmpipe(), llvmpipe_sse41(), softpipe()};
  return kProfiles;
}

std::optional<Profile> find_profile(std::string_view name) {
  for (const Profile& profile : profiles()) {
    if (profile.name == name) return profile;
  }
  return std::nullopt;
}

}  // namespace softfocus
