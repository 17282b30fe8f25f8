#include "scenes/make/sphere_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/random_bits.h"
#include "scenes/make/procedural_texture.h"
#include "scenes/make/shapes.h"

namespace softfocus {
namespace {

constexpr double kFocus = 2.0;    // metres, as all here
constexpr double kNearest = 1.0;  // of the spheres' centres
constexpr double kFarthest = 12.0;
constexpr double kFovYDegrees = 45.0;
// Radii on a picture whose height is 2. 250 discs of these cover the picture twice over.
constexpr double kSmallest = 0.06;
constexpr double kLargest = 0.14;

Material sphere_material() {
  Material material;
  material.name = "spheres";
  material.diffuse = glm::vec3{1.0f};
  material.specular = glm::vec3{0.3f};
  material.shininess = 40;
  material.texture = 0;
  return material;
}

Texture sphere_texture() {
  return make_procedural_texture(
      *find_texture_pattern("marble"),
      {.size = 256, .cells = 4, .colours = {{0.85f, 0.83f, 0.78f}, {0.10f, 0.16f, 0.34f}}});
}

// The picture's places by the additive sequence of the plastic number (Roberts 2018), which
// leaves no gaps; the depth by chance, evenly in its reciprocal and so in the signed radius
// of the circle of confusion.
Object placed_sphere(int index, double aspect, RandomSequence& random) {
  const auto place = [&](double step) {
    const double sum = 0.5 + step * (index + 1);
    return 2.0 * (sum - std::floor(sum)) - 1.0;
  };
  const double depth = 1.0 / next_between(random, 1.0 / kFarthest, 1.0 / kNearest);
  const double half_height = depth * exact_math::tan_degrees(kFovYDegrees / 2.0);
  Object object;
  object.position = {place(0.7548776662466927) * aspect * half_height,
                     place(0.5698402909980532) * half_height, -depth};
  object.scale =
      glm::dvec3{next_between(random, kSmallest, kLargest) * std::sqrt(aspect) * half_height};
  for (int axis = 0; axis < 3; ++axis) {
    object.rotation_degrees[axis] = next_between(random, 0.0, 360.0);
  }
  return object;
}

}  // namespace

SphereCut sphere_cut(int triangles) {
  assert(triangles >= kLeastFieldTriangles && triangles <= kMostFieldTriangles);
  // A sphere has two triangles for each segment of each ring but one.
  const double cells = triangles / (2.0 * kFieldSpheres);
  SphereCut best{3, 2};
  double best_error = HUGE_VAL;
  int best_shape = 0;
  const int most_bands = std::max(static_cast<int>(std::sqrt(cells)), 1);
  for (int bands = std::max(most_bands / 2, 1); bands <= most_bands; ++bands) {
    const int segments = std::max(static_cast<int>(std::lround(cells / bands)), 3);
    const double error = std::fabs(segments * bands - cells);
    const int shape = std::abs(segments - 2 * bands);  // twice as many around: square cells
    if (error < best_error || (error == best_error && shape < best_shape)) {
      best = {segments, bands + 1};
      best_error = error;
      best_shape = shape;
    }
  }
  return best;
}

Scene sphere_field(int triangles, double aspect) {
  Scene scene;
  scene.name = "spheres";
  scene.title = "Sphere field";
  scene.camera = {.position = {0.0, 0.0, 0.0},
                  .target = {0.0, 0.0, -1.0},
                  .fov_y_degrees = kFovYDegrees,
                  .near_m = 0.1,
                  .far_m = 50.0};
  // The horizon has a circle of 26 pixels of 1024, a radius.
  scene.lens = {.lens = {.focal_length_mm = 85.0, .f_number = 1.0, .focus_m = kFocus},
                .coc_scale = 1.0,
                .max_coc_px_at_1024 = 16.0};
  scene.background = {0.30f, 0.46f, 0.68f};
  scene.ambient_light = glm::vec3{0.3f};
  scene.lights = {{LightKind::directional, {-0.5f, 0.9f, 0.6f}, {0.95f, 0.90f, 0.80f}}};
  scene.textures = {sphere_texture()};
  scene.materials = {sphere_material()};
  const SphereCut cut = sphere_cut(triangles);
  scene.meshes = {make_sphere(1.0, cut.segments, cut.rings)};
  repeat_uvs(scene.meshes[0], {4.0, 2.0});
  RandomSequence random{250};
  for (int i = 0; i < kFieldSpheres; ++i) {
    scene.objects.push_back(placed_sphere(i, aspect, random));
  }
  return scene;
}

}  // namespace softfocus
