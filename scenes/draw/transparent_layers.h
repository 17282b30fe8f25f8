#pragma once
// Transparent surfaces: peeled in a pass of their own against the depths of what is opaque, and
// blended from back to front.
//
//   p = half(o c), o' = half(o)       a fragment of lit colour c and opacity o
//   colour = p + (1 - o') colour      from the farthest layer to the nearest, lay_over()
//
// A pixel keeps its kTransparentLayers nearest transparent fragments that lie before the opaque
// surface; those behind them are left out. Of fragments at one depth the first drawn is the
// nearest, and one at the depth of the opaque surface is hidden.
//
// Alpha is the depth of the nearest surface, transparent or opaque, whose opacity is 1/2 or more:
// the one that one sees most of. A method that gets one picture blurs all of a pixel by it.
//
// Peeled, and not blended as it is drawn, so that the order of objects does not matter; in a pass
// of its own, so that a scene without transparent surfaces is drawn as it was.

#include <array>
#include <cstddef>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/pipeline/render_pass.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/split_layer_row.h"

namespace softfocus {

struct Camera;

inline constexpr std::size_t kTransparentLayers = kMaxLayers;
static_assert(kTransparentLayers == kMostTransparent);

/// What a pass of transparent surfaces draws to: colour times opacity, opacity in alpha; and the
/// depth buffers. The nearest layer comes first.
struct TransparentTargets {
  std::array<Image, kTransparentLayers> colour, depth;
};

TransparentTargets make_transparent_targets(int width, int height);

/// Lets a pass draw to them.
void set_targets(TransparentTargets& targets, RenderPass& pass);

DepthsInMetres depths_in_metres(const Camera& camera);

/// Draws a tile's layers: all of the tile begins at the depths of `opaque_depth`. The pass has
/// set_targets() and was sorted into `lists`. Returns how many layers show something.
std::size_t draw_transparent_tile(const RenderPass& pass, const TileLists& lists, int tile,
                                  const Image& opaque_depth, TransparentTargets& targets,
                                  TileMemory& memory);

/// Blends the first `layers` of a tile into its pixels, RGBA16F, which lie at `texels` in rows
/// `stride_bytes` apart. The tile was drawn before `opaque_depth`.
void blend_transparent_tile(const TransparentTargets& targets, std::size_t layers,
                            const Image& opaque_depth, const Rectangle& area,
                            const DepthsInMetres& in_metres, const Profile& profile, Isa isa,
                            std::byte* texels, std::size_t stride_bytes);

/// A layer as depth of field takes it: TransparentLayer of dof.h.
struct TransparentPicture {
  Image colour, opacity;
};

/// Makes pictures of the first `layers` of a tile. `opaque` gives its depths where a layer shows
/// nothing.
void store_transparent_tile(const TransparentTargets& targets, std::size_t layers,
                            const Rectangle& area, const DepthsInMetres& in_metres,
                            const Image& opaque, const Profile& profile, Isa isa,
                            std::vector<TransparentPicture>& pictures);

/// A picture with layers blended into it, as blend_transparent_tile() does it.
Image blended(const Image& opaque, const std::vector<TransparentPicture>& layers,
              const Profile& profile, ThreadPool& pool);

/// For DofInput::transparent. The pictures must outlive it.
std::vector<TransparentLayer> views_of(const std::vector<TransparentPicture>& pictures);

}  // namespace softfocus
