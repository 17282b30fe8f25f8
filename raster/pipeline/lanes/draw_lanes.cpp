#include "raster/pipeline/lanes/draw_lanes.h"

#include <algorithm>

namespace softfocus {

bool can_draw_in_lanes(const RenderPass& pass, const DrawState& state) {
  const RenderTargets& targets = pass.targets;
  const ColourState& colour = state.colour[0];
  const bool one_target = targets.colour[0] != nullptr &&
                          targets.colour[0]->format == Format::rgba16f &&
                          std::all_of(targets.colour.begin() + 1, targets.colour.end(),
                                      [](const Image* image) { return image == nullptr; });
  return pass.isa != Isa::scalar && pass.profile.coverage == Coverage::edge_functions &&
         pass.profile.attributes != AttributeSetup::planes_by_quad && one_target &&
         targets.depth != nullptr && state.depth &&
         !(state.stencil && targets.stencil != nullptr) && !state.scissor && !colour.blend &&
         colour.write == std::array{true, true, true, true};
}

}  // namespace softfocus
