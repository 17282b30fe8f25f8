#pragma once
// A frame's list of draws, for the emulation and for a GL driver.

#include <vector>

#include "raster/pipeline/state.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {

/// One object. The pointers are into the scene.
struct SurfaceDraw {
  DrawState state;
  SurfaceVertexInput input;
  const Texture* texture;  ///< none if the variant is not textured
  SurfaceOpacity opacity;
  SurfaceVariant variant;  ///< the features of the material
};

/// Whether a surface is blended with what lies behind it.
bool is_transparent(const Material& material, const Mesh& mesh);

/// Whether any of a scene's objects is.
bool has_transparent(const Scene& scene);

/// One for each of the scene's objects, in the order of drawing. Those of opacity 0 show nothing:
/// callers leave them out.
std::vector<SurfaceDraw> surface_draws(const Scene& scene, const CameraMatrices& camera,
                                       double frame);

}  // namespace softfocus
