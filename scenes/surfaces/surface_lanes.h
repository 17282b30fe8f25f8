#pragma once
// The stages of surface_stages.h as vector kernels.

#include "raster/lanes/isa.h"
#include "raster/pipeline/lanes/draw_in_lanes.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {

using SurfaceLaneStages = LaneStages<SurfaceVertexStage<kMostSurfaceVaryings>,
                                     SurfaceFragmentStage<kMostSurfaceVaryings>>;

/// The kernels of a variant for an isa other than scalar. The fragment stage's `decoded`
/// texture is read in place of its `texture`.
SurfaceLaneStages surface_lane_stages(const SurfaceVariant& variant, Isa isa);

}  // namespace softfocus
