#pragma once
// Few views, each spread over its cell of the lens (view_spread.h), and averaged: between the
// filters and the accumulation in time and in error.

#include <vector>

#include "scenes/filtered_views/lens_cells.h"
#include "scenes/filtered_views/spread_tile.h"
#include "scenes/lens_views/accumulation.h"

namespace softfocus {

/// Views from as many lens_cells(), each spread over its cell. The means of their
/// rays are added in binary32 by kSampleGroup, and these sums in binary64. From so many views
/// on that a cell is one point it is accumulation(), to the bit.
///
/// Views made for a number have nothing in common with those for another. So with `until` the
/// picture is made of 8 views, of 16, of 32, ..., and half_set_rms is how far it is from the one of
/// half as many.
SampledPicture filtered_views(const LensViewInput& input, ThreadPool& pool);

/// The views of a picture if no number is given: the most that one group draws.
inline constexpr int kFilteredViews = kSampleGroup;

/// The most views of a tile, with Sampling::by_tile, if no number is given: of twice that none is
/// spread.
inline constexpr int kMostFilteredViewsByTile = 32;

/// Made once for many pictures of one scene.
struct FilteredViewsBuffer {
  AccumulationBuffer views;
  ApertureShape aperture;  ///< of the cells, as is `jitter`
  bool jitter = false;
  LensCells cells;
  ViewSpread spread;
  std::vector<ViewTiles> pictures;  ///< of a group
  SampleSums sums;                  ///< of filtered_views()
};

/// Needs set_views(). The scene must outlive it.
FilteredViewsBuffer make_filtered_views_buffer(const LensViewInput& input, ThreadPool& pool);

/// filtered_views() of the buffer's scene.
SampledPicture filtered_views(FilteredViewsBuffer& buffer, const LensViewInput& input,
                              ThreadPool& pool);

/// Makes the cells for so many views.
void set_views(FilteredViewsBuffer& buffer, const LensViewInput& input, int views);

/// Draws the views `begin` to `end` - 1, at most kSampleGroup, in the tiles, or in all if there are
/// none.
void draw_views(FilteredViewsBuffer& buffer, const LensViewInput& input, int begin, int end,
                std::span<const int> tiles, ThreadPool& pool);

/// Spreads the views that draw_views() has drawn last in the tiles, or in all, and adds them to the
/// sums. They must have been drawn in the tiles' neighbours too.
void spread_views(const FilteredViewsBuffer& buffer, int begin, int end, std::span<const int> tiles,
                  SampleSums& sums, ThreadPool& pool);

/// Draws, spreads and adds the buffer's views, but for the first that the sums count already.
void add_filtered_views(FilteredViewsBuffer& buffer, const LensViewInput& input, SampleSums& sums,
                        ThreadPool& pool);

/// The circles that the input's lens gives.
PixelCoc coc_of(const LensViewInput& input);

// As many views as each tile needs, each spread over its cell of the lens.

/// filtered_views() with Sampling::by_tile. tile_samples() of the first kFirstTileViews give the
/// number of a tile's views. A cell is made for the number of views; so a tile that needs more
/// than the first begins anew with the views for its number, which are drawn in its neighbours
/// too, and is to the bit the tile of a picture of so many views.
SampledPicture filtered_views_by_tile(FilteredViewsBuffer& buffer, const LensViewInput& input,
                                      ThreadPool& pool);

}  // namespace softfocus
