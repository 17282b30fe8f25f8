#pragma once
// From a scene to draw calls.

#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/parallel.h"
#include "scenes/scene.h"
#include "scenes/view.h"

namespace softfocus {

/// What a picture holds where nothing was drawn: the background, at the far distance.
glm::vec4 clear_colour(const Scene& scene);

/// Draws one frame into an RGBA16F image of any size: linear colour, and in alpha the
/// depth in metres along the axis (the camera's far distance where nothing was drawn).
/// The same bits for any number of threads.
Image draw_scene(const Scene& scene, const View& view, double frame, int width, int height,
                 const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
