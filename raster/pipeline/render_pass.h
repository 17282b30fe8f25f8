#pragma once
// A render pass: draw calls are recorded, then carried out together. finish() runs
// three loops over the pool: vertices; triangles (clip, set up, sort into tiles);
// tiles (fragments). Within a pixel, fragments merge in the order of submission, so
// the result depends neither on tiles nor on threads.
//
//   RenderPass pass{.targets = {.colour = {&picture}, .depth = &depth}, .profile = profile};
//   draw(pass, state, indices, vertex_count, vertex_stage, fragment_stage);   // draw.h
//   finish(pass, pool);

#include <glm/vec4.hpp>
#include <optional>
#include <vector>

#include "raster/numbers/isa.h"
#include "raster/numbers/profile.h"
#include "raster/parallel.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/lane_draw.h"
#include "raster/pipeline/merge.h"
#include "raster/pipeline/state.h"

namespace softfocus {

struct RenderPass {
  RenderTargets targets;
  Profile profile;
  /// What finish() sets the targets to before it draws; none: they keep what they hold.
  std::optional<glm::vec4> clear_colour = {};
  std::optional<float> clear_depth = {};
  /// Whether depths are wanted after finish(): else the depth buffer may hold anything.
  bool keep_depth = true;
  /// Of the draws that are recorded in lanes.
  Isa isa = Isa::scalar;
  std::vector<DrawCall> draws;
  /// Kept from one finish() to the next: memory that is new to a process is slow.
  LaneMemory memory = {};
};

/// Width and height of the targets, as the rectangle (0, 0) to (width, height). Needs
/// at least one target.
Rectangle target_area(const RenderTargets& targets);

/// Carries out the recorded draws and forgets them.
void finish(RenderPass& pass, ThreadPool& pool);

}  // namespace softfocus
