#pragma once
// How far a picture is off, from a sample of its tiles: so few that their ground truth is cheap to
// draw, and taken mostly where the lens changes the picture.

#include <cstddef>
#include <vector>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct SampledTile {
  int tile = 0;         ///< counted row by row
  double chance = 1.0;  ///< with which it was taken, above 0
};

/// Tiles of kTileSize pixels, those of the rasterizer.
struct TileSample {
  int width = 0;
  int height = 0;
  int tiles_x = 0;
  std::vector<SampledTile> tiles;  ///< in ascending order
};

/// About `count` tiles, all of them if there are no more. A tile's chance is proportional to the
/// mean of |sqrt(sharp) - sqrt(blurred)| over its pixels (light cut to 0..1, the largest channel)
/// plus 1/500, and at most 1. Systematic sampling with a fixed start: the same on every machine.
TileSample sample_tiles(const Image& sharp, const Image& blurred, int count, ThreadPool& pool);

/// A mean over all pixels of the picture, and how far off it may be.
struct Estimate {
  double mean = 0.0;
  double standard_error = 0.0;
};

/// The mean FLIP, each tile by itself: values of the sampled tiles over their chances (Horvitz and
/// Thompson 1952), with the standard error after Deville (1999). Of both pictures only the sampled
/// tiles are looked at.
Estimate flip_of_tiles(const TileSample& sample, const Image& truth, const Image& test,
                       ThreadPool& pool);

}  // namespace softfocus
