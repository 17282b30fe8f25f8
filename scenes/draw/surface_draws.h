#pragma once
// A frame's list of draws, for the emulation and for a GL driver.

#include <vector>

#include "raster/pipeline/state.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/surface_stages.h"
#include "scenes/scene.h"

namespace softfocus {

/// One object. The pointers are into the scene.
struct SurfaceDraw {
  DrawState state;
  SurfaceVertexInput input;
  const Texture* texture;  ///< none if the variant is not textured
  const Texture* opacity;  ///< none if the variant is not cut out
  Sampler opacity_sampler;
  SurfaceVariant variant;  ///< the features of the material
};

/// One for each of the scene's objects, in the order of drawing.
std::vector<SurfaceDraw> surface_draws(const Scene& scene, const CameraMatrices& camera,
                                       double frame);

}  // namespace softfocus
