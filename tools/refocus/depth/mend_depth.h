#pragma once
// Depth as it comes, mended: too few pixels, edges that are a mixture of two depths, too few
// steps. Every function is a map of pixels and gives the same bits on any number of threads.

#include <optional>
#include <span>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "raster/threads/parallel.h"
#include "tools/refocus/depth/depth_map.h"

namespace softfocus {

// Depths on their way through a picture of halves.
//
// A half has 11 bits, so a circle r = R (z - f) / z, with the horizon's R and the focus f, is known
// to (R - r) / 2048 pixels. That is little, but where all that is in the picture lies near the
// focus of a strong lens, as in a close-up, and R is hundreds of pixels. Another lens R' < R has
// the same circles at other depths,
//
//   z' = f' R' / (R' - r)
//
// of the same order, and to (R' - r) / 2048 pixels. R' needs to be above the largest circle behind
// the focus, no more.

/// The other lens, and the way from depths of the one to those of the other.
struct FinerLens {
  double far_px, focus_m;  ///< R, f
  double other_px;         ///< R'
  PixelCoc coc;            ///< R', f'
};

/// For depths between two finite ones. None where circles are known to a 32nd of a pixel in focus,
/// or the other lens would not halve the error.
std::optional<FinerLens> finer_lens(float nearest_m, float farthest_m, const PixelCoc& coc);

void to_finer_depths(std::span<float> metres, const FinerLens& lens);

/// Replaces depths, finite ones, by those of the other lens, and returns it; or leaves them.
std::optional<PixelCoc> with_finer_depths(DepthMap& map, const PixelCoc& coc);

struct Mending {
  bool by_colour = true;  ///< a smaller map is upsampled along the edges of the colour
  bool edges = false;
  bool bands = false;
};

/// The repairs that were made.
struct MendedDepth {
  bool upsampled = false;
  bool bands = false;
  std::size_t edge_pixels = 0;
};

/// Codes of whole numbers as numbers between them: a slope that was rounded to steps becomes a
/// slope again. Each code moves by half a step at most, so an edge of two steps or more stays.
PlaneValues without_bands(const PlaneValues& codes, int width, int height, ThreadPool& pool);

/// The map at the size of `colour`, RGBA16F. Needs known depths. On a smooth surface 1/z is
/// interpolated. Elsewhere, around each pixel lie 5x5 depths
/// of the smaller map, weighted by how near they lie and how like the pixel's colour theirs is
/// (Kopf et al. 2007). Their mean would lie between two surfaces: the depth is the weighted mean of
/// those alone that are within a twentieth of the weighted median.
DepthMap upsampled_by_colour(const DepthMap& map, const Image& colour, ThreadPool& pool);

/// The map at that size, by the nearest pixel.
DepthMap upsampled_to_nearest(const DepthMap& map, int width, int height);

/// A depth that lies between two surfaces, two pixels to either side along a row, a column or a
/// diagonal, becomes that of the surface whose depth it is nearer to, as that is what most of the
/// pixel shows. Returns how many there were.
std::size_t mend_edges(DepthMap& map, ThreadPool& pool);

/// Brings the map to the size of `colour`, and mends its edges if that is wanted.
void mend(DepthMap& map, const Image& colour, const Mending& mending, MendedDepth& mended,
          ThreadPool& pool);

}  // namespace softfocus
