#pragma once
// From a scene to draw calls.

#include <glm/vec4.hpp>
#include <vector>

#include "raster/images/decoded_texture.h"
#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/render_pass.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"

namespace softfocus {

/// The background at the far distance: a picture's colour where nothing is drawn.
glm::vec4 clear_colour(const Scene& scene);

/// Draws one frame into an RGBA16F image of any size: linear colour, and in alpha the
/// depth in metres along the axis (the camera's far distance where nothing was drawn).
/// The same bits for any number of threads.
Image draw_scene(const Scene& scene, const CameraMatrices& camera, double frame, int width,
                 int height, const Profile& profile, ThreadPool& pool);

/// A scene made ready for many frames: decoded textures, and memory to use again.
struct PreparedScene {
  const Scene* scene;
  std::vector<DecodedTexture> textures;  ///< decoded, for drawing in lanes
  RenderPass pass;
  Image depth;
};

/// The scene must outlive the result. `pool` is the one that will draw.
PreparedScene prepare_scene(const Scene& scene, const Profile& profile, ThreadPool& pool);

/// As above, into an RGBA16F picture.
void draw_scene(PreparedScene& prepared, const CameraMatrices& camera, double frame, Image& picture,
                ThreadPool& pool);

/// Records the clearing and the draws of a frame into a pass, which has its targets, and the
/// profile and isa of prepare_scene(). Depths are not kept.
void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass);

}  // namespace softfocus
