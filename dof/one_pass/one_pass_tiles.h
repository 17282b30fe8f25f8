#pragma once
// The one-pass filter in tiles, on a unit with kernels.

#include <cstddef>
#include <cstdint>

#include "dof/dof.h"

namespace softfocus {

/// A sample of a ring as the kernels take it.
struct TileTap {
  std::int32_t offset;  ///< from the receiver's place in a plane
  float distance_px;
};

/// A tile's pixels and its neighbours', in planes of rows. As many of its places as a
/// vector has lanes are called a window; vectors begin anywhere.
struct TilePlanes {
  int stride;          ///< from row to row
  std::size_t length;  ///< from plane to plane

  float* whole;  ///< intensity, intensity * red, green, blue: what overlap 1 and leakage 1 add
  float* part;   ///< radius, its sign set beyond the focus; red, green, blue

  float* least;      ///< of the window that begins here: the least radius
  float* least_all;  ///< the same, but 0 where a pixel of it lies beyond the focus
  float* most;       ///< the largest radius
};

/// Two rows of a part of a tile and of the picture. The lower one may lie past the
/// picture's edge: then it has no target.
struct TileRows {
  int x_begin, x_end;
  int width;  ///< of the picture
  const std::uint16_t* from[2];
  std::uint16_t* to[2];
};

/// As one_pass().
void one_pass_tiles(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
