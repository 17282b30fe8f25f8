#include "scenes/shadows/volumes/pixel_space.h"

namespace softfocus {

PixelSpace pixel_space(const ShadowView& view, glm::dvec3 eye) {
  const auto row = [&](int i) {
    const glm::dmat4& m = view.world_to_clip;
    return glm::dvec3{m[0][i], m[1][i], m[2][i]};
  };
  PixelSpace space{};
  space.eye = eye;
  space.rows = {(row(0) + row(3)) * (view.width / 2.0), (row(1) + row(3)) * (view.height / 2.0),
                row(3)};
  const auto& [x, y, w] = space.rows;
  const double determinant = dot(x, cross(y, w));
  space.columns = {cross(y, w) / determinant, cross(w, x) / determinant, cross(x, y) / determinant};
  space.facing = determinant > 0.0 ? -1.0 : 1.0;
  // z = a w + b, and -w = z is the near plane. A quarter of its depth: samples may come nearer.
  const double a = dot(row(2), w) / dot(w, w);
  const double b = dot(row(2), eye) + view.world_to_clip[3][2];
  space.least_w = -0.25 * b / (1.0 + a);
  return space;
}

glm::dvec3 to_pixels(const PixelSpace& space, glm::dvec3 from_eye) {
  return {dot(space.rows[0], from_eye), dot(space.rows[1], from_eye), dot(space.rows[2], from_eye)};
}

glm::dvec3 from_pixels(const PixelSpace& space, glm::dvec3 v) {
  return (space.columns[0] * v.x + space.columns[1] * v.y) + space.columns[2] * v.z;
}

glm::dvec3 to_light(const PixelSpace& space, const ShadowLight& light) {
  return to_pixels(space, light.place - space.eye * light.w);
}

}  // namespace softfocus
