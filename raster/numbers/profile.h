#pragma once
// A profile says in what GPUs differ: a small value that stores, samplers and draw calls
// read. Nothing else in the pipeline varies.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

#include "raster/numbers/half.h"

namespace softfocus {

/// Precision of a bilinear fetch's two weights and of the trilinear one.
enum class BilinearWeights : std::uint8_t {
  binary32,  ///< the fraction of u * width - 0.5 in single precision
  fixed_8,   ///< rounded to 8 fractional bits first (D3D11.3 7.18.8: 16.8 coordinates)
};

/// How the standard texture unit filters linear bytes and halves. It filters all other
/// formats in floats.
enum class BilinearFilter : std::uint8_t {
  floats,    ///< decoded, then lerps in binary32
  integers,  ///< exact sums with 8-bit weights, whatever BilinearWeights says (integer_filter.h)
};

/// Whether a product and the sum it feeds are rounded once or twice.
enum class Contraction : std::uint8_t { unfused, fused };

/// How a float becomes one of 256 levels, after scaling to 0 to 255.
enum class UnormRounding : std::uint8_t { half_up, nearest_even };

/// How textures are addressed and filtered.
enum class TextureUnit : std::uint8_t {
  /// As the specifications say, with `bilinear_weights` and `bilinear_filter`.
  standard,
  /// Mesa 22.3 llvmpipe: 8-bit textures in 8-bit integers, its own wrapping in floats.
  llvmpipe,
  /// Mesa 22.3 softpipe: everything in floats, its own wrapping.
  softpipe,
  /// SwiftShader: everything in floats, bytes scaled last, its own wrapping.
  swiftshader,
};

/// Which pixels a triangle covers.
enum class Coverage : std::uint8_t {
  /// Positions snapped to the subpixel grid, then exact integer edge functions.
  edge_functions,
  /// Spans between float edges, row by row, from unsnapped positions (softpipe).
  scanlines,
};

/// Which pixel centres exactly on an edge are inside: those on left edges always; on level
/// edges, those on the upper or on the lower one as seen in the picture (row 0 on top).
enum class FillRule : std::uint8_t { upper_left, lower_left };

/// What happens to triangles that are not wholly inside the clip planes.
enum class Clipping : std::uint8_t {
  standard,
  /// Mesa 22.3's draw module. It cuts window-linear varyings by the places of their images,
  /// and culls by unsnapped positions, too, each batch that has a vertex outside.
  mesa,
};

/// How attributes are interpolated over a triangle.
enum class AttributeSetup : std::uint8_t {
  /// Barycentric weights from the exact integer edge functions: always convex,
  /// watertight, good for slivers.
  exact_barycentric,
  /// Planes a0 + dadx x + dady y from unsnapped positions, evaluated from the
  /// framebuffer origin (llvmpipe of Mesa 22 and 23).
  planes_from_origin,
  /// Planes from the vertices sorted from top to bottom, evaluated once in each 2x2
  /// block of pixels and stepped within it (softpipe).
  planes_by_quad,
};

/// What becomes of binary32 subnormals in shaders and 32-bit float textures.
enum class Denormals : std::uint8_t { keep, flush };

/// By default the profile `ieee`.
struct Profile {
  HalfRounding half_store = HalfRounding::nearest_even;
  UnormRounding unorm_store = UnormRounding::half_up;
  Denormals denormals = Denormals::keep;

  TextureUnit texture_unit = TextureUnit::standard;
  BilinearWeights bilinear_weights = BilinearWeights::binary32;  ///< of the standard unit
  BilinearFilter bilinear_filter = BilinearFilter::floats;       ///< of the standard unit
  Contraction lerp = Contraction::unfused;                       ///< a + t (b - a)

  /// ndc * scale + translate. New vertices, made by clipping, are never fused.
  Contraction viewport = Contraction::unfused;
  /// Clip planes stand at |x| = guard_band * w: 1 is the viewport's edge. At most 16.
  float guard_band = 16.0f;
  Clipping clipping = Clipping::standard;
  Coverage coverage = Coverage::edge_functions;
  int subpixel_bits = 8;  ///< of edge_functions: positions are multiples of 2^-bits, 4 to 8
  FillRule fill_rule = FillRule::upper_left;
  AttributeSetup attributes = AttributeSetup::exact_barycentric;
  Contraction interpolation = Contraction::unfused;  ///< of planes_from_origin

  bool operator==(const Profile&) const = default;
};
static_assert(std::is_trivially_copyable_v<Profile>);

/// A profile that the program knows.
struct NamedProfile {
  std::string_view name;
  std::string_view summary;
  Profile profile;
};

/// All of them, `ieee` first.
std::span<const NamedProfile> profiles();

/// The profile of that name, if there is one.
std::optional<Profile> find_profile(std::string_view name);

}  // namespace softfocus
