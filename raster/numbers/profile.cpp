#include "raster/numbers/profile.h"

#include <array>

namespace softfocus {
namespace {

constexpr Profile kD3d11{.half_store = HalfRounding::toward_zero,
                         .denormals = Denormals::flush,
                         .bilinear_weights = BilinearWeights::fixed_8,
                         .bilinear_filter = BilinearFilter::integers};

// Mesa's software rasterizers were measured; docs/specification.md has every operation.
constexpr Profile llvmpipe(Contraction contraction) {
  return {.half_store = HalfRounding::toward_zero,
          .unorm_store = UnormRounding::nearest_even,
          .denormals = Denormals::flush,
          .texture_unit = TextureUnit::llvmpipe,
          .lerp = contraction,
          .viewport = contraction,
          .guard_band = 1.0f,
          .clipping = Clipping::mesa,
          .attributes = AttributeSetup::planes_from_origin,
          .interpolation = contraction};
}

constexpr Profile kSoftpipe{.half_store = HalfRounding::toward_zero,
                            .unorm_store = UnormRounding::nearest_even,
                            .texture_unit = TextureUnit::softpipe,
                            .guard_band = 1.0f,
                            .clipping = Clipping::mesa,
                            .coverage = Coverage::scanlines,
                            .attributes = AttributeSetup::planes_by_quad};

// Probed in a page, by WebGL2; docs/exactness.md has what it does not describe.
constexpr Profile kSwiftShader{.half_store = HalfRounding::swiftshader,
                               .unorm_store = UnormRounding::nearest_even,
                               .denormals = Denormals::flush,
                               .texture_unit = TextureUnit::swiftshader,
                               .guard_band = 4.0f,
                               .subpixel_bits = 4};

constexpr std::array kProfiles{
    NamedProfile{"ieee",
                 "IEEE 754 throughout: stores round to nearest even, float weights, nothing fused",
                 {}},
    NamedProfile{"d3d11",
                 "the Direct3D 11.3 specification: stores truncate, 8-bit bilinear weights",
                 kD3d11},
    NamedProfile{"llvmpipe", "Mesa 22.3 llvmpipe on a CPU with fused multiply-add",
                 llvmpipe(Contraction::fused)},
    NamedProfile{"llvmpipe-sse41", "Mesa 22.3 llvmpipe held to SSE4.1: nothing fused",
                 llvmpipe(Contraction::unfused)},
    NamedProfile{"softpipe", "Mesa 22.3 softpipe: float spans, float textures, nothing fused",
                 kSoftpipe},
    NamedProfile{"swiftshader", "SwiftShader through ANGLE, a browser's software GPU: nearly",
                 kSwiftShader},
};

}  // namespace

std::span<const NamedProfile> profiles() { return kProfiles; }

std::optional<Profile> find_profile(std::string_view name) {
  for (const NamedProfile& known : kProfiles) {
    if (known.name == name) return known.profile;
  }
  return std::nullopt;
}

}  // namespace softfocus
