#pragma once
// Several samples a pixel. A fragment stage runs once for each pixel of a triangle; coverage, depth
// and stencil are each sample's own. A multisampled image has a row for each sample of a row of
// pixels: sample s of pixel (x, y) is texel (x, y * samples + s).

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"

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

/// A pixel's samples as two surfaces, for filters that blur each at its own depth. `texel` has the
/// larger part of the pixel, the nearer surface if both have as much.
struct PixelSurfaces {
  glm::vec4 texel;  ///< linear colour, and in alpha the depth in metres
  glm::vec4 other;  ///< of the other surface; anything if that has no part
  int other_samples = 0;
  int first = 0;  ///< the first sample of `texel`'s surface
};

/// A pixel whose farthest depth is at most this many times the nearest shows one surface.
inline constexpr float kOneSurface = 1.03125f;

/// Samples of a pixel, each linear colour and depth above 0, as surfaces: the nearer one has the
/// samples before 2 / (1 / nearest + 1 / farthest), where circles of confusion have half their
/// difference. Colours and depths are means, sums in the samples' order times 1 / count.
PixelSurfaces surfaces_of(std::span<const glm::vec4> samples);

/// Where a pass leaves what surfaces_of() makes of each pixel: images of the target's pixels.
struct SurfaceTargets {
  Image* picture = nullptr;   ///< RGBA16F
  Image* other = nullptr;     ///< RGBA16F: the other surface; anything where it has no part
  Image* coverage = nullptr;  ///< r8: the other surface's part of the pixel
  /// r32f, or null: window depths of `picture`, at its surface's first sample.
  Image* depth = nullptr;
  int y_begin = 0;  ///< the row of the target that is the images' first
};

/// The surfaces of an area's pixels from multisampled images, of colour with depth in alpha and of
/// window depths.
void find_surfaces(const Image& colour, const Image& depth, int samples, const Rectangle& area,
                   const SurfaceTargets& to, const Profile& profile);

/// How an r8 image holds `count` of `samples`.
inline std::uint8_t coverage_byte(int count, int samples) {
  return static_cast<std::uint8_t>((count * 255 + samples / 2) / samples);
}

}  // namespace softfocus
