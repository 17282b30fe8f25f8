#pragma once
// As many views as each tile needs, each spread over its cell of the lens.

#include "scenes/filtered_views/filtered_views.h"

namespace softfocus {

/// filtered_views() with Sampling::by_tile. tile_samples() of the first kFirstTileViews give the
/// number of a tile's views. A cell is made for the number of views; so a tile that needs more
/// than the first begins anew with the views for its number, which are drawn in its neighbours
/// too, and is to the bit the tile of a picture of so many views.
SampledPicture filtered_views_by_tile(FilteredViewsBuffer& buffer, const LensViewInput& input,
                                      ThreadPool& pool);

}  // namespace softfocus
