#pragma once
// A fragment stage with every kind of varying, in its scalar form and in lanes.

#include <array>

#include "raster/lanes/isa.h"
#include "raster/pipeline/lanes/draw_in_lanes.h"
#include "raster/pipeline/stages.h"
#include "tests/support/raster_helpers.h"

namespace softfocus::test {

/// Every kind of varying, and differences of them.
struct MixedColour {
  static constexpr std::array kInterpolation{Interpolation::perspective, Interpolation::linear,
                                             Interpolation::perspective, Interpolation::flat};
  static constexpr bool kNeedsDerivatives = true;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<4>& in) const {
    const float side = in.front_facing ? in.varyings[2] : -in.varyings[2];
    return {{glm::vec4{in.varyings[0] + in.ddx[0], in.varyings[1] - in.ddy[0], side,
                       in.varyings[3] + in.ddx[1]}},
            false};
  }
};

/// For vertices that are listed. Needs an isa with vectors.
LaneStages<ListedVertices<4>, MixedColour> mixed_stages(Isa isa);

}  // namespace softfocus::test
