#include "scenes/make/backdrop.h"

#include <algorithm>
#include <cmath>

#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

double distance_from_eye_m(const Backdrop& backdrop, const Object& object) {
  const glm::dvec3 way = object.position - backdrop.eye;
  return std::sqrt(dot(way, way));
}

}  // namespace

std::optional<double> backdrop_distance_m(const Scene& scene) {
  std::optional<double> nearest;
  if (!scene.backdrop) return nearest;
  for (const Object& object : scene.objects) {
    const double distance_m = distance_from_eye_m(*scene.backdrop, object);
    if (distance_m <= scene.backdrop->beyond_m) continue;
    nearest = std::min(nearest.value_or(distance_m), distance_m);
  }
  return nearest;
}

void set_backdrop(Scene& scene, double distance_m) {
  const Backdrop& backdrop = scene.backdrop.value();
  const double factor = distance_m / backdrop_distance_m(scene).value();
  for (Object& object : scene.objects) {
    if (distance_from_eye_m(backdrop, object) <= backdrop.beyond_m) continue;
    object.position = backdrop.eye + factor * (object.position - backdrop.eye);
    object.scale *= factor;
    object.sway *= factor;
  }
  scene.camera.far_m *= std::max(factor, 1.0);
}

}  // namespace softfocus
