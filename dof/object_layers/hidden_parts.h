#pragma once
// What lies behind the borders of nearer things, continued from what is visible beside them.
//
// Where neighbours show two surfaces (picture_objects.h), the farther one, of radius r_b, goes on
// behind the nearer one, of radius r at the pixel. From the lens's edge one sees past a border by
//
//   g = r_b - r   pixels:   so at distance d from the last visible pixel, 1, 2, ..., it is there
//   with a share of min(1, g + 1 - d)
//
// Each pixel looks left, right, up and down for the surface that goes on there: the one whose
// border it met last on its way, nothing as far having come between. The nearest of the four is the
// hidden object. Those of the others that show the same object, or one as far (within 3/4 pixel
// of radius), count with it, weighed by 1 / d. So what a pole hides is drawn out from both its
// sides, in a straight line from one border's colour and depth to the other's. Mirror images about
// the border in place of its colour keep the texture, but are farther from the truth on scenes.

#include <cstdint>
#include <vector>

#include "dof/object_layers/picture_objects.h"

namespace softfocus {

/// A picture's surfaces. The last pixel of a row repeats up to the stride.
struct Surfaces {
  Planes visible;  ///< colour and signed radius
  /// The planes of hidden_plane. A hidden surface with a share of 0 is black.
  Planes hidden;
};
namespace hidden_plane {
inline constexpr int kColour = 0, kRadius = 3, kShare = 4;
inline constexpr int kFarthest = 5;  ///< the largest radius of the visible surface's object
inline constexpr int kCount = 6;
}  // namespace hidden_plane

Surfaces find_surfaces(const DofInput& input, ThreadPool& pool);

// Which rungs the surfaces of a picture have where, so that tiles leave out the others.

struct LayerMarks {
  static constexpr int kBlock = 16;  ///< pixels across a block
  int columns, rows;
  /// Of a block, before the focus and behind it: a bit for each rung, numbered over all levels.
  std::vector<std::uint64_t> blocks[2];

  /// All rungs in a rectangle of the picture. What lies outside repeats its border.
  std::uint64_t rungs_in(int side, int x, int y, int width, int height) const;
};

LayerMarks mark_layers(const Surfaces& surfaces, ThreadPool& pool);

}  // namespace softfocus
