#pragma once
// A texture as vector code samples it: decoded once for a profile's texture unit, every
// texel four floats, so that nothing is converted a pixel. raster/images/sample_lanes.inl
// reads it.

#include <array>
#include <cstdint>
#include <vector>

#include "raster/images/sampler.h"
#include "raster/images/texture.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// A lane of the widest vector for each: 16384x16384 texels have 15 levels.
inline constexpr std::size_t kMaxDecodedLevels = 16;

/// Widths or heights of the levels.
struct DecodedAxis {
  alignas(64) std::array<float, kMaxDecodedLevels> sizes{};
  alignas(64) std::array<float, kMaxDecodedLevels> inverses{};  ///< 1 / size, rounded
  bool are_powers_of_two = false;                               ///< all of them
  bool base_is_power_of_two = false;                            ///< level 0's
};

struct DecodedTexture {
  const Texture* source = nullptr;  ///< what it was made of, which must outlive it
  int level_count = 0;
  /// Whether texels are left from 0 to 255, for they are filtered in integers: to_linear()
  /// follows the filter.
  bool are_bytes = false;
  DecodedAxis u, v;
  /// Where each level's texels start in `texels`, in floats. Rows lie without gaps.
  alignas(64) std::array<std::int32_t, kMaxDecodedLevels> starts{};
  /// Red, green, blue and alpha of each texel, as fetch_texel() gives them or as
  /// `are_bytes` says. Empty where sample() must do: for softpipe, for more levels than
  /// kMaxDecodedLevels and for 2^31 floats and more.
  std::vector<float, RowAllocator<float>> texels;
};

/// `texture`, which must have a level, for the texture unit of `profile`.
DecodedTexture decode_texture(const Texture& texture, const Profile& profile);

/// In which arithmetic sample_lanes() samples: one of those that have a vector form, or
/// sample() itself, lane by lane.
enum class LaneArithmetic : std::uint8_t {
  by_sample,
  standard,           ///< the standard unit with binary32 weights, nothing fused
  standard_fixed_8,   ///< the same with weights of 8 bits
  standard_integers,  ///< its filter in integers, of bytes
  llvmpipe_fused,     ///< llvmpipe's float filter
  llvmpipe_unfused,   ///< the same, nothing fused
  llvmpipe_integers,  ///< its filter of 8-bit integers
};

/// The one that `sampler` and `profile` need, for which the texture was decoded. Constant
/// in a draw.
LaneArithmetic lane_arithmetic(const DecodedTexture& texture, const Sampler& sampler,
                               const Profile& profile);

}  // namespace softfocus
