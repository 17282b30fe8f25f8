#pragma once
// Where in the picture the faces of shadow volumes may meet rays, and in which bands of it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/shadows/volumes/shadow_volumes.h"

namespace softfocus {

/// The pixels of a block's row, which the widest unit takes at once.
inline constexpr int kSampleBlockSize = 8;

/// Pixels are counted in blocks, which most faces cover whole or not at all, in bands of blocks,
/// which are tasks.
inline constexpr int kSampleBlockPixels = kSampleBlockSize * kSampleBlockSize;
inline constexpr int kBandRows = 4 * kSampleBlockSize;
inline constexpr int kSampleBlockRows = kBandRows / kSampleBlockSize;

/// How far a sample may lie from its pixel's centre, in pixels.
inline constexpr double kFarthest = 0.5;

/// Beyond what a sample may lie away, for the rounding of outlines.
inline constexpr double kReach = kFarthest + 0x1p-6;

/// The faces of a light, and which corners of theirs are infinitely far: those from `first_far` on.
struct SeenFaces {
  std::span<const VolumeFace> faces;
  std::span<const glm::dvec3> corners;
  std::uint32_t first_far;
};

inline std::array<glm::dvec3, 3> corners_of(const VolumeFace& face, const SeenFaces& of) {
  return {of.corners[face.corners[0]], of.corners[face.corners[1]], of.corners[face.corners[2]]};
}

/// All corners of an array of faces: the joined ones, then those at infinity.
std::vector<glm::dvec3> corners_in_pixels(const PixelSpace& space, const JoinedFacets& joined,
                                          const ShadowLight& light, ThreadPool& pool);

/// Where in the window a face can meet rays: a convex polygon.
struct Outline {
  std::array<glm::dvec2, 4> corners;
  std::size_t count = 0;
};

Outline outline_of(const VolumeFace& face, const SeenFaces& of, VolumeCount count,
                   const PixelSpace& space, const ShadowView& view);

struct Extremes {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

inline void widen(Extremes& range, double to) {
  range.low = std::min(range.low, to);
  range.high = std::max(range.high, to);
}

Extremes rows_of(const Outline& outline);

/// Between two heights.
Extremes columns_of(const Outline& outline, double y_low, double y_high);

/// The whole numbers from one place to another, within 0 <= n < most.
struct Cells {
  int begin, end;
};

Cells cells_within(double low, double high, int size, int most);

/// CSR: the faces that may meet band i's samples are faces[begins[i]] to faces[begins[i + 1] - 1].
struct Bands {
  std::vector<std::size_t> begins;
  std::vector<std::uint32_t> faces;
};

Bands sort_into_bands(const SeenFaces& of, VolumeCount count, const PixelSpace& space,
                      const ShadowView& view, ThreadPool& pool);

}  // namespace softfocus
