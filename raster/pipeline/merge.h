#pragma once
// The end of the pipe: depth and stencil tests, blending, and the stores.

#include <array>
#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"

namespace softfocus {

/// Where a render pass draws: images of one size, null if not used. The depth buffer is r32f
/// (cleared to 1 by the caller), the stencil buffer r8.
struct RenderTargets {
  std::array<Image*, kMaxColourTargets> colour{};
  Image* depth = nullptr;
  Image* stencil = nullptr;
};

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
