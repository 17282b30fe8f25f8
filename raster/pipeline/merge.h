#pragma once
// The end of the pipe: depth and stencil tests, blending, layers, and the stores.

#include <array>
#include <cstddef>
#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"

namespace softfocus {

/// Colour, and depth as r32f.
struct LayerTarget {
  Image* colour = nullptr;
  Image* depth = nullptr;
};

inline constexpr std::size_t kMaxLayers = 4;

/// Where a render pass draws: images of one size, null if not used. The depth buffer is r32f
/// (cleared to 1 by the caller), the stencil buffer r8.
///
/// A pass may peel (a k-buffer, Bavoil et al. 2007): colour[0] and `depth` then show the nearest
/// fragment of each pixel, behind[0] the next, and so on, from the first to the last that is used.
/// Of fragments at one depth the first submitted is the nearest. Such a pass has no other targets,
/// colour of RGBA16F, and draws that test for less and write depth, without stencil, blending or
/// masks.
///
/// With 4 or 8 samples all are multisampled images (multisample.h), and the pass does not peel.
struct RenderTargets {
  std::array<Image*, kMaxColourTargets> colour{};
  Image* depth = nullptr;
  Image* stencil = nullptr;
  std::array<LayerTarget, kMaxLayers - 1> behind{};
  int samples = 1;
};

/// 1, or how many layers a pass peels.
std::size_t layer_count(const RenderTargets& targets);

inline bool has_layers(const RenderTargets& targets) { return targets.behind[0].colour != nullptr; }

/// Layer 0 is colour[0] and `depth`.
inline LayerTarget layer_target(const RenderTargets& targets, std::size_t layer) {
  return layer == 0 ? LayerTarget{targets.colour[0], targets.depth} : targets.behind[layer - 1];
}

/// Whether the targets and a draw's state are those of a pass that peels.
bool can_peel(const RenderTargets& targets, const DrawState& state);

/// Whether a fragment is among a pixel's nearest, of those submitted so far.
bool reaches_layers(const RenderTargets& targets, int x, int y, float depth);

/// Inserts a fragment that reaches_layers() before the farther ones. Each of these moves back by a
/// layer.
void insert_into_layers(const RenderTargets& targets, int x, int y, float depth, glm::vec4 colour,
                        const Profile& profile);

/// Runs the stencil test, then the depth test at a pixel, and updates both buffers. True if the
/// fragment passes. A test without a state or a buffer passes and writes nothing.
bool depth_stencil_test(const DrawState& state, const RenderTargets& targets, int x, int y,
                        float depth, bool front_facing);

/// The stored stencil value after an operation.
std::uint8_t apply(StencilOp op, const StencilFace& face, std::uint8_t stored);

/// source * factor (op) destination * factor in binary32, each product rounded.
glm::vec4 blend(const BlendState& state, glm::vec4 source, glm::vec4 destination);

/// Blends and stores one colour. Before blending into a normalised format the colour is
/// clamped to 0..1 (OpenGL 4.6, 17.3.6). A channel that is not written keeps its bits.
void write_colour(const ColourState& state, Image& target, int x, int y, glm::vec4 colour,
                  const Profile& profile);

}  // namespace softfocus
