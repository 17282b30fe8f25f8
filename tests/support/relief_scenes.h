#pragma once
// One mesh under a light, for tests of reliefs.

#include <utility>

#include "scenes/make/shapes.h"
#include "scenes/scene.h"

namespace softfocus::test {

inline Scene lit_mesh(Mesh mesh) {
  Scene scene;
  scene.lights = {{LightKind::directional, {0.3f, 0.8f, 1.0f}, glm::vec3{1.0f}}};
  scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  scene.objects.push_back({});
  return scene;
}

/// A torus around which the camera turns.
inline Scene orbited_torus(int segments, double degrees_per_frame) {
  Scene scene = lit_mesh(make_torus(0.7, 0.3, segments, segments / 2));
  scene.camera.position = {1.5, 2.0, 3.5};
  scene.camera.orbit_degrees_per_frame = degrees_per_frame;
  return scene;
}

}  // namespace softfocus::test
