#pragma once
// Several samples a pixel. A fragment stage runs once for each pixel of a triangle; coverage, depth
// and stencil are each sample's own. A multisampled image has a row for each sample of a row of
// pixels: sample s of pixel (x, y) is texel (x, y * samples + s).

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"

namespace softfocus {

inline constexpr int kMaxSamples = 8;

/// Of 1, 4 or 8 samples: their places from the pixel's centre, in 1/256 pixel. Direct3D's standard
/// ones (D3D11.3 19.2.4.1), which drivers have too.
std::span<const glm::ivec2> sample_places(int samples);

/// How far samples lie from the centre along x or y, at most, in 1/256 pixel.
int sample_reach(int samples);

/// The sum of a pixel's samples in their order, times 1 / samples in binary32, for each pixel of an
/// RGBA16F or r32f image. llvmpipe takes it of colours; of depths it takes sample 0.
Image resolve(const Image& multisampled, int samples, const Profile& profile);

// Edges: pixels that another surface shares with the one at their centre, for filters that blur
// each at its own depth. The picture itself is one sample a pixel.

/// Where a pass leaves the edges of its first colour: images of the target's pixels.
struct EdgeTargets {
  int samples = 0;  ///< 4 or 8, besides the pixel's centre
  /// RGBA16F: other_surface() of the samples that do not show the centre's, or anything.
  Image* other = nullptr;
  Image* coverage = nullptr;  ///< r8: the part of a pixel that `other` has
  int y_begin = 0;            ///< the row of the target that is the images' first
};

/// Depths at most this many times another are of one surface.
inline constexpr float kOneSurface = 1.03125f;

inline bool is_one_surface(float depth, float other) {
  return depth <= other * kOneSurface && other <= depth * kOneSurface;
}

struct OtherSurface {
  glm::vec4 texel{};
  int samples = 0;
};

/// Of samples, linear colour and depth, those of one surface alike, that which lies apart from the
/// centre's. If all have the centre's depth, it is all of them. Else it is those whose 1 / depth,
/// in which circles of confusion are linear, is nearer to that of the sample farthest from the
/// centre than to the centre's. Of these it has the mean colour, a sum in their order times 1 /
/// count, and the depth that most of them have, the first of these.
OtherSurface other_surface(float centre_depth, std::span<const glm::vec4> samples);

/// The edges of a picture from a multisampled image of it, both with depths in alpha. The centre's
/// surface is what is_one_surface() with it. Needs y_begin 0.
void find_edges(const Image& picture, const Image& multisampled, const EdgeTargets& to,
                const Profile& profile, ThreadPool& pool);

/// How an r8 image holds `count` of `samples`.
inline std::uint8_t coverage_byte(int count, int samples) {
  return static_cast<std::uint8_t>((count * 255 + samples / 2) / samples);
}

}  // namespace softfocus
