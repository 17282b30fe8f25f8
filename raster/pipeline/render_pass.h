#pragma once
// A render pass: draw calls are recorded, then carried out together. finish() runs
// three loops over the pool: vertices; triangles (clip, set up, sort into tiles);
// tiles (fragments). Within a pixel, fragments merge in the order of submission, so
// the result depends neither on tiles nor on threads.
//
//   RenderPass pass{.targets = {.colour = {&picture}, .depth = &depth}, .profile = profile};
//   draw(pass, state, indices, vertex_count, vertex_stage, fragment_stage);   // draw.h
//   finish(pass, pool);

#include <vector>

#include "raster/numbers/profile.h"
#include "raster/parallel.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/merge.h"
#include "raster/pipeline/state.h"

namespace softfocus {

struct RenderPass {
  RenderTargets targets;
  Profile profile;
  std::vector<DrawCall> draws;
};

/// Width and height of the targets, as the rectangle (0, 0) to (width, height). Needs
/// at least one target.
Rectangle target_area(const RenderTargets& targets);

/// Carries out the recorded draws and forgets them.
void finish(RenderPass& pass, ThreadPool& pool);

}  // namespace softfocus
