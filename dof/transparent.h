#pragma once
// Transparent layers before a filtered picture.
//
// One picture has one depth a pixel, so a method blurs glass and the wall behind it by one circle.
// Here the wall, as the opaque picture, and each layer of glass are pictures of their own, and the
// method blurs each. A layer is blurred twice: its colour times opacity C, and its opacity A, with
// the same depths and so with the same weights. Then, from the farthest layer to the nearest,
//
//   picture = C + (1 - A) picture        (raster/passes/over.h)
//
// Where a layer shows nothing it is black, of opacity 0, at the opaque picture's depth. So what is
// opaque and nearer than glass hides it with its own blurred edge.
//
// Of each method the layers want only what it does to any picture, so that all have transparency;
// blending within a method would be right for one.
//
// Known failures: light bends in no glass; a blurred opaque thing before glass lies under the glass
// in the part of its edge that one sees through; where two transparent surfaces change places in
// the layers, at the outline of the nearer, the farther changes its layer.

#include <functional>

#include "dof/dof.h"

namespace softfocus {

using FilterPicture = std::function<void(const DofInput& input, const ImageView& result)>;

/// Lays the input's transparent layers, filtered as the scene was, over `result`, the filtered
/// scene. Alpha is that of the nearest layer whose opacity is 1/2 or more, where there is such.
void lay_transparent_over(const DofInput& input, const ImageView& result,
                          const FilterPicture& filter, ThreadPool& pool);

}  // namespace softfocus
