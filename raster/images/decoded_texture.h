#pragma once
// A texture decoded once for a profile's texture unit, every texel four floats.
// sample_lanes.inl reads it and need not convert texels pixel by pixel.

#include <array>
#include <cstdint>

#include "raster/images/sampler.h"
#include "raster/lanes/isa.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// One lane of the widest vector a level. 16384x16384 texels have 15 levels.
inline constexpr std::size_t kMaxDecodedLevels = 16;

/// Widths or heights of the levels.
struct DecodedAxis {
  alignas(64) std::array<float, kMaxDecodedLevels> sizes{};
  alignas(64) std::array<float, kMaxDecodedLevels> inverses{};  ///< 1 / size, rounded
  bool are_powers_of_two = false;                               ///< all of them
  bool base_is_power_of_two = false;                            ///< level 0's
};

struct DecodedTexture {
  const Texture* source = nullptr;  ///< must outlive this
  int level_count = 0;
  /// Whether texels keep whole numbers: 0 to 255 to be filtered in integers, for SwiftShader 0 to
  /// 65280. to_linear() comes after the filter then.
  bool are_whole = false;
  DecodedAxis u, v;
  DecodedAxis w;  ///< of a volume's slices
  /// Width, width, height, height of level 0, as largest_square_of_quads() takes them.
  std::array<float, 4> quad_sizes{};
  /// Where each level's texels start in `texels`, in floats. Rows lie without gaps, and so do
  /// slices. Faces of a cube have a border of one texel, which lies before their first: what is
  /// beyond an edge or a corner (sliced_texture.h).
  alignas(64) std::array<std::int32_t, kMaxDecodedLevels> starts{};
  /// Red, green, blue and alpha of each texel, from fetch_texel() or as `are_whole` says. Null
  /// if only sample() will do: for softpipe's flat textures and arrays, more than
  /// kMaxDecodedLevels levels, or 2^31 floats.
  RowMemory<float> texels;
};

/// Halves as floats; not for the scalar unit.
void decode_halves(Isa isa, const std::uint16_t* from, std::size_t count, float* to);

/// Decodes for the texture unit of `profile`. Needs at least one level.
DecodedTexture decode_texture(const Texture& texture, const Profile& profile,
                              Isa isa = Isa::scalar);

/// The arithmetic of sample_lanes().
enum class LaneArithmetic : std::uint8_t {
  by_sample,          ///< none in lanes: sample(), lane by lane
  standard,           ///< the standard unit: binary32 weights, unfused
  standard_fixed_8,   ///< the standard unit with 8-bit weights
  standard_integers,  ///< the standard unit's integer filter, of bytes
  standard_flushed,   ///< SwiftShader's volumes and cubes: as `standard`, and floats are flushed
  llvmpipe_fused,     ///< llvmpipe's float filter
  llvmpipe_unfused,   ///< llvmpipe's float filter, unfused
  llvmpipe_integers,  ///< llvmpipe's filter in 8-bit integers
  swiftshader,        ///< SwiftShader's filter, in floats
};

/// The arithmetic for a texture that was decoded for `profile`. It stays the same in a draw.
LaneArithmetic lane_arithmetic(const DecodedTexture& texture, const Sampler& sampler,
                               const Profile& profile);

/// Where a texture is sampled, pixel after pixel.
struct SamplePoints {
  const float* u;
  const float* v;
  const float* lod;
  const float* w = nullptr;  ///< of a texture that is not flat
};

/// sample_lanes() of a unit with vectors, sample_sliced() of a texture that is not flat; `colours`:
/// RgbaLanes of that unit.
void sample_vectors(Isa isa, const DecodedTexture& texture, const Sampler& sampler,
                    const Profile& profile, const SamplePoints& points, int count, void* colours);

}  // namespace softfocus
