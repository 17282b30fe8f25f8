#pragma once
// A relief texture of a height field: a grid of heights over a plane, seen from straight above.

#include <cstdint>
#include <optional>
#include <vector>

#include "scenes/relief/relief_texture.h"

namespace softfocus {

/// Row by row from the top; a texel's side is the unit of its heights.
struct HeightField {
  int width = 0, height = 0;  ///< 1 to kMostReliefSize
  /// In texels, upwards. NaN and infinity are holes.
  std::vector<float> heights;
  /// As ReliefTexture has them. Empty: the surface is white, lit from the upper left.
  std::vector<std::uint32_t> colours = {};
};

struct HeightForm {
  double texel_m = 1.0;
  int depth_bits = 8;  ///< or 16
  bool with_normals = false;
};

/// x to the right, y up the picture, z towards the viewer; the middle of the field at x = y = 0,
/// the height 0 at z = 0. The highest texel has the depth 0, the lowest the last; if all have one
/// height, the depth is a texel's side. None if there are holes alone.
std::optional<ReliefTexture> relief_of_heights(const HeightField& field, const HeightForm& form);

}  // namespace softfocus
