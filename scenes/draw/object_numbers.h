#pragma once
// Which of a scene's objects each pixel shows, for methods that read DofInput::objects.

#include <cstdint>
#include <vector>

#include "dof/dof.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"

namespace softfocus {

/// The number of the object at each pixel's centre, row by row from the top: 1 for the scene's
/// first object, 0 where nothing is drawn; from 65,535 objects on numbers begin again at 1. The
/// object is that of the pixel in draw_scene()'s picture: the same triangles, the same depth test.
std::vector<std::uint16_t> draw_object_numbers(const Scene& scene, const CameraMatrices& camera,
                                               double frame, int width, int height,
                                               const Profile& profile, ThreadPool& pool);

/// The same for a method that reads them; none for others, for which nothing is drawn.
std::vector<std::uint16_t> object_numbers_for(const Method& method, const Scene& scene,
                                              const CameraMatrices& camera, double frame, int width,
                                              int height, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
