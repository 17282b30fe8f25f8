#pragma once
// A small scene for tests of shadows: cubes and a ball on a floor, a lamp and a sun.

#include "scenes/draw/shadowed_layers.h"
#include "scenes/make/shapes.h"
#include "scenes/scene.h"

namespace softfocus::test {

inline Scene shadow_scene(ShadowKind kind) {
  Scene scene;
  scene.camera.position = {0.5, 2.2, 4.0};
  scene.camera.target = {0.0, 0.3, 0.0};
  Light lamp, sun;
  lamp.kind = LightKind::point;
  lamp.position_or_direction = {0.6f, 2.0f, 0.9f};
  lamp.colour = {0.5f, 0.6f, 0.4f};
  sun.position_or_direction = {-1.0f, 1.2f, 0.4f};
  sun.colour = {0.7f, 0.4f, 0.3f};
  scene.lights = {lamp, sun};
  scene.materials = {Material{}};
  scene.meshes = {make_plane(6, 6, 4, 4), make_cube(0.7, 1), make_sphere(0.4, 16, 8)};
  Object ground, cube, other, ball;
  cube.mesh = other.mesh = 1;
  ball.mesh = 2;
  cube.position = {-0.7, 0.35, 0.0};
  other.position = {0.6, 0.6, -0.6};
  other.rotation_degrees = {20, 30, 10};
  ball.position = {0.5, 0.4, 0.8};
  scene.objects = {ground, cube, other, ball};
  set_shadows(scene, kind);
  return scene;
}

}  // namespace softfocus::test
