#pragma once
// Highlights: pixels out of focus and much brighter than their surroundings. They are taken out
// of the picture and drawn as discs of their circle at full resolution, with all of their light.
// A blur at half resolution would give them soft, wide rims. Lights of up to some 20 pixels
// across are taken out so, pixel by pixel.
//
// L of a pixel is its largest channel. m is the mean over 16 cells on a square of 12x12 cells
// about the pixel's, of the largest L in the cell. Of a pixel with L > k m, k = 2, the excess is
//   e = c (1 - k m / L) sat(2 |r| - 1)
// which leaves the picture; the disc adds e / area to each pixel inside.
//
// A disc behind the focus is drawn on what lies behind the focus too, if that is not much less
// blurred, which would hide the disc:
//   visible(r) = sat(4 r / b - 1) for r >= 0, b the lower end of the disc's octave
//                sat(-r - 2) for r < 0: the background behind the near field
// and the near field covers it. A disc before the focus is drawn over all.
//
// With corners they are regular polygons in place of discs, upside down before the focus.
//
// Sums are exact, in units of 2^-34 (scatter.h): neither order nor threads matter.

#include <cstdint>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/scatter/scatter_discs.h"

namespace softfocus {

struct Highlight {
  int x;
  int layer;  ///< kHighlightNear or the octave of its radius
  int disc;
  float excess[3];
};
inline constexpr int kHighlightOctaves = 11, kHighlightNear = kHighlightOctaves;
inline constexpr int kHighlightLayers = kHighlightOctaves + 1;

struct Highlights {
  std::vector<std::vector<Highlight>> rows;  ///< of the picture
  ScatterDiscs discs;                        ///< of a polygon its rows above the middle
  ScatterDiscs below;  ///< of a polygon; a disc is the same both ways, and this is empty
  int reach = -1;      ///< the largest disc's rows above and below its centre; -1 if there is none
};

/// How many cells away the surroundings are, even: larger lights stay in the picture.
inline constexpr int kHighlightReach = 6;
/// How much brighter than its surroundings a highlight is: k.
inline constexpr float kHighlightContrast = 2.0f;

/// The excess of a pixel beside surroundings m; all 0 if it is none.
void highlight_excess(const SplitTexel& texel, float surroundings, float* excess);

/// The layer of a radius.
int highlight_layer(float radius_px);
/// visible(r) of a disc in a layer, at a pixel of radius r.
float highlight_visible(int layer, float radius_px);

/// The discs' light in a row. `sums` has room for a row of kHighlightLayers * 3 planes,
/// `stride` apart; only layers in the mask that comes back are written.
struct HighlightScratch {
  std::vector<std::int64_t> differences;
};
std::uint32_t highlight_row(const Highlights& highlights, int y, int width,
                            HighlightScratch& scratch, float* sums, std::ptrdiff_t stride);

}  // namespace softfocus
