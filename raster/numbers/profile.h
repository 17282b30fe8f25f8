#pragma once
// A profile names what differs between GPUs. Each one is a small value that the
// stores, samplers and the draw call read; nothing else in the pipeline varies.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "raster/numbers/half.h"

namespace softfocus {

/// Precision of the two weights of a bilinear fetch and of the trilinear one.
enum class BilinearWeights : std::uint8_t {
  binary32,  ///< the fraction of u * width - 0.5 in single precision
  fixed_8,   ///< rounded to 8 fractional bits first (D3D11.3 7.18.8: 16.8 coordinates)
};

/// Whether a product and the sum it feeds are rounded once or twice.
enum class Contraction : std::uint8_t { unfused, fused };

/// How attributes are interpolated over a triangle.
enum class AttributeSetup : std::uint8_t {
  /// Barycentric weights from the exact integer edge functions: always convex,
  /// watertight, good for slivers.
  exact_barycentric,
  /// Planes a0 + dadx x + dady y from unsnapped positions, evaluated from the
  /// framebuffer origin (llvmpipe of Mesa 22 and 23).
  planes_from_origin,
};

/// What becomes of binary32 subnormals in shaders and 32-bit float textures.
enum class Denormals : std::uint8_t { keep, flush };

struct Profile {
  std::string_view name;
  std::string_view summary;
  HalfRounding half_store = HalfRounding::nearest_even;
  BilinearWeights bilinear_weights = BilinearWeights::binary32;
  Contraction lerp = Contraction::unfused;           ///< a + t (b - a)
  Contraction viewport = Contraction::unfused;       ///< ndc * scale + translate
  Contraction interpolation = Contraction::unfused;  ///< of planes_from_origin
  AttributeSetup attributes = AttributeSetup::exact_barycentric;
  Denormals denormals = Denormals::keep;
  /// Clip planes stand at |x| = guard_band * w: 1 is the viewport's edge. At most 16.
  float guard_band = 16.0f;
};

/// The profiles that the program knows, `ieee` (the default) first.
std::span<const Profile> profiles();

/// The profile of that name, if there is one.
std::optional<Profile> find_profile(std::string_view name);

}  // namespace softfocus
