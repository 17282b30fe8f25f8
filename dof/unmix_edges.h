#pragma once
// Edges of a picture that a renderer or a camera made. Its colours are means over a pixel, and
// more: on an edge of two surfaces they are a mixture. Its depths are of one place in the pixel.
// Blurred as it is, the mixture is spread with the wrong surface's circle: a sharp ghost of a
// blurred thing, stairs on a sharp one. So a pixel on an edge is taken apart into its two surfaces'
// colours and their parts, as smooth_edges.h takes them.
//
// Known failures: a pixel of three surfaces has two, or stays as it is, as do edges of like colours
// and a strand of hair over a texture.

#include <cstddef>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// DofInput::edges of a picture.
struct UnmixedEdges {
  Image other{}, coverage{};  ///< without texels if there is nothing to take apart
  std::size_t pixels = 0;     ///< that were taken apart
};

/// Takes edges of `scene` apart, RGBA16F with depths in alpha: its pixels get the colour of the
/// surface that alpha is of. In focus smooth_edges() puts both together again, to what the pixel
/// was. A picture whose colours are not mixed, one sample a pixel, is left as it is. The same bits
/// for any number of threads.
UnmixedEdges unmix_edges(const ImageView& scene, const DofSettings& settings,
                         const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
