#pragma once
// The stages of surface_stages.h as vector kernels.

#include "raster/lanes/isa.h"
#include "raster/pipeline/lanes/draw_in_lanes.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {

template <SurfaceVariant variant>
using SurfaceLaneStages = LaneStages<SurfaceVertexStage<variant>, SurfaceFragmentStage<variant>>;

/// The kernels of a variant for an isa other than scalar. The fragment stage's `decoded`
/// texture is read in place of its `texture`.
template <SurfaceVariant variant>
SurfaceLaneStages<variant> surface_lane_stages(Isa isa);

}  // namespace softfocus
