#pragma once
// A render pass: draw calls are recorded, then carried out together. finish() runs
// three loops over the pool: vertices; triangles (clip, set up, sort into tiles);
// tiles (fragments). Within a pixel, fragments merge in the order of submission,
// so the result does not depend on tiles or threads.
//
//   RenderPass pass{.colour = {&picture}, .depth = &depth, .profile = profile};
//   draw(pass, state, indices, vertex_count, vertex_stage, fragment_stage);
//   finish(pass, pool);

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/parallel.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/state.h"

namespace softfocus {

struct RenderPass {
  /// Targets of one size, any format; unused ones are null. The depth buffer is r32f,
  /// the stencil r8. Each is optional; a test whose buffer is missing passes.
  RenderTargets targets;
  Profile profile;
  std::vector<std::unique_ptr<DrawCall>> draws;
};

}  // namespace softfocus
