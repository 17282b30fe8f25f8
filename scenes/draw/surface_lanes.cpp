#include "scenes/draw/surface_lanes.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "raster/numbers/fixed_point.h"

#define SOFTFOCUS_KERNELS "scenes/draw/surface_lanes.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

template <SurfaceVariant variant>
SurfaceLaneStages<variant> surface_lane_stages(Isa isa) {
  return {SOFTFOCUS_KERNEL(isa, place_surface_vertices<variant>),
          SOFTFOCUS_KERNEL(isa, shade_surface_vertices<variant>),
          SOFTFOCUS_KERNEL(isa, shade_surface_fragments<variant>)};
}

template SurfaceLaneStages<SurfaceVariant{false, false, false}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{false, false, true}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{false, true, false}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{false, true, true}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{true, false, false}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{true, false, true}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{true, true, false}> surface_lane_stages(Isa);
template SurfaceLaneStages<SurfaceVariant{true, true, true}> surface_lane_stages(Isa);

}  // namespace softfocus
