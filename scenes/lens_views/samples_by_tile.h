#pragma once
// As many samples as each tile needs: one in focus few, one with silhouettes many.
//
// All tiles take the first size of tile_sample_sizes(). How far these views differ
// decides which size a tile goes on to. The views are growing_lens_points() of
// these sizes: no view is drawn for nothing, and a tile is to the bit what it is in a picture in
// which all tiles take so many of these views.
//
// Known failures: what lies between the first views, a thin thing far out of focus, is not seen by
// them and may be missed; a tile is 64x64 pixels, so a scene with something out of focus in
// every tile saves nothing.

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/lens_view_method.h"

namespace softfocus {

// How far the first views of a tile differ, as a viewer sees it: what decides how many more it
// needs.

/// Steps of a colour on its way from 0 to 1: of its square root, which is near to how bright it
/// looks.
inline constexpr int kBrightnessSteps = 4095;

/// Of one of a tile's pixels and colours, the difference is that of the largest and the least of
/// the views' values, both taken as 0 to 1, in kBrightnessSteps. Returned is the sum of the
/// squares. Whole numbers: the same in any order. `views` are RGBA16F, `pixels` each.
std::uint64_t squared_difference(std::span<const std::uint16_t* const> views, int pixels);

/// Fewer can miss what lies between them.
inline constexpr int kFirstTileViews = kSampleGroup;

/// The numbers of samples that a tile can have, up to `most`: kFirstTileViews, eight times that and
/// so on, as long as the next is four times as many, then `most`. (With sizes that double, tiles in
/// between are rarely worth it: a view's vertices are shaded for all tiles, and sets that double
/// are less good. Mean FLIP at equal time is 3 % more.)
std::vector<int> tile_sample_sizes(int most);

/// The size for a tile whose first views have this squared_difference(), of so many pixels. It
/// goes on from n samples if the root of the mean square is above 1.5 % of the way from black to
/// white, times (n / 8)^(3/4): the error of n views made for their number falls by about that.
int tile_samples(std::uint64_t squares, int pixels, std::span<const int> sizes);

/// Puts the buffer's views where and when accumulation_by_tile() has them. Beyond
/// kMostFewLensPoints they are the sequences.
void place_growing_views(AccumulationBuffer& buffer, const Sampling& sampling);

/// accumulation() with Sampling::by_tile.
SampledPicture accumulation_by_tile(AccumulationBuffer& buffer, const LensViewInput& input,
                                    ThreadPool& pool);

/// A picture of sums whose tiles have their own counts.
SampledPicture picture_by_tile(const SampleSums& sums, const LensViewInput& input,
                               ThreadPool& pool);

}  // namespace softfocus
