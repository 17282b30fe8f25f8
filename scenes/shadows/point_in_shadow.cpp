#include "scenes/shadows/point_in_shadow.h"

#include <limits>

#include "scenes/shadows/light_grid.h"
#include "scenes/shadows/projected_shadows.h"

namespace softfocus {
double ray_hit(const Facet& facet, glm::dvec3 from, glm::dvec3 direction) {
  const auto& [a, b, c] = facet.corners;
  const glm::dvec3 edge1 = b - a, edge2 = c - a;
  const glm::dvec3 p = cross(direction, edge2);
  const double determinant = dot(edge1, p);
  if (determinant == 0.0) return -1.0;
  const glm::dvec3 from_a = from - a;
  const double u = dot(from_a, p) / determinant;
  const glm::dvec3 q = cross(from_a, edge1);
  const double v = dot(direction, q) / determinant;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 ? dot(edge2, q) / determinant : -1.0;
}

bool point_in_shadow(const Facets& facets, std::uint32_t facet, bool seen_from_back,
                     glm::dvec3 point, const ShadowLight& light,
                     std::span<const std::uint32_t> casters) {
  const std::uint32_t number = facets.receiver_of[facet];
  const Receiver& receiver = facets.receivers[number];
  const LitSide lit = lit_side(receiver, light, facets.epsilon_m);
  if (lit == LitSide::both) return false;
  if (lit != (seen_from_back ? LitSide::back : LitSide::front)) return true;
  const glm::dvec3 towards = light.place - point * light.w;
  for (const std::uint32_t caster : casters) {
    if (facets.receiver_of[caster] == number ||
        !stops_light(facets.facets[caster], facets.planes[caster], light)) {
      continue;
    }
    const double t = ray_hit(facets.facets[caster], point, towards);
    if (!(t > 0.0) || (light.w != 0.0 && t >= 1.0)) continue;
    const double height = height_over(receiver.plane, point + towards * t);
    if ((lit == LitSide::front ? height : -height) > facets.epsilon_m) return true;
  }
  return false;
}

glm::dvec3 seen_point(const FacetPlane& plane, const glm::dmat4& world_to_clip, glm::dvec3 eye,
                      glm::dvec2 window, int width, int height) {
  // The rows of the matrix say where a point is: (row_x - ndc_x row_w) . p = 0, likewise y. Both
  // planes hold the eye, and meet in the ray.
  const double x = window.x / width * 2.0 - 1.0, y = window.y / height * 2.0 - 1.0;
  const auto plane_through_eye = [&](int row, double ndc) {
    return glm::dvec3{world_to_clip[0][row] - ndc * world_to_clip[0][3],
                      world_to_clip[1][row] - ndc * world_to_clip[1][3],
                      world_to_clip[2][row] - ndc * world_to_clip[2][3]};
  };
  const glm::dvec3 ray = cross(plane_through_eye(0, x), plane_through_eye(1, y));
  const double slope = dot(plane.normal, ray);
  if (slope == 0.0) return eye;
  return eye + ray * ((plane.offset - dot(plane.normal, eye)) / slope);
}

}  // namespace softfocus
