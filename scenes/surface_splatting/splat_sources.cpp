#include "scenes/surface_splatting/splat_sources.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "dof/dof.h"
#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "scenes/surface_splatting/surface_splats.h"

namespace softfocus {
namespace {

// Vertices are snapped to 256ths of a pixel, as the rasterizer's are: then every point of the
// screen between two triangles of a mesh belongs to exactly one. Cut to 2^20 pixels.
constexpr double kSubpixels = 256.0;
constexpr double kFarthestPx = 1048576.0;

struct Polygon {
  int corners = 0;
  std::array<glm::dvec3, 4> at;
};

// What lies beyond the near plane (Sutherland and Hodgman 1974).
Polygon cut_near(const std::array<glm::dvec3, 3>& corners, double near_m) {
  Polygon polygon;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 a = corners[i], b = corners[(i + 1) % 3];
    const double inside_a = -a.z - near_m, inside_b = -b.z - near_m;
    if (inside_a >= 0.0) polygon.at[static_cast<std::size_t>(polygon.corners++)] = a;
    if ((inside_a >= 0.0) == (inside_b >= 0.0)) continue;
    glm::dvec3 cut = a + (b - a) * (inside_a / (inside_a - inside_b));
    cut.z = -near_m;
    polygon.at[static_cast<std::size_t>(polygon.corners++)] = cut;
  }
  return polygon;
}

std::int64_t snapped(double px) {
  const double cut = std::min(std::max(px, -kFarthestPx), kFarthestPx);
  return static_cast<std::int64_t>(std::floor(cut * kSubpixels + 0.5));
}

// The plane that 1/depth is on the screen: with n the normal and d = n.v of a corner, a point at
// depth z on the ray of tangents (t_x, t_y) has z n.(t_x, t_y, -1) = d.
bool find_inverse_depth(const SplatCamera& camera, const std::array<glm::dvec3, 3>& corners,
                        glm::dvec3& plane) {
  const glm::dvec3 n = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double d = dot(n, corners[0]);
  if (d == 0.0) return false;  // seen from its edge
  const RayCamera& rays = camera.rays;
  plane.x = n.x * rays.pixel_x / d;
  plane.y = n.y * rays.pixel_y / d;
  plane.z = -n.z / d - plane.x * rays.centre_x - plane.y * rays.centre_y;
  return true;
}

void reverse(SeenTriangle& seen) {
  const auto corners = static_cast<std::ptrdiff_t>(seen.corners);
  std::reverse(seen.x.begin(), seen.x.begin() + corners);
  std::reverse(seen.y.begin(), seen.y.begin() + corners);
}

std::int64_t twice_area(const SeenTriangle& seen) {
  std::int64_t area = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(seen.corners); ++i) {
    const std::size_t j = (i + 1) % static_cast<std::size_t>(seen.corners);
    area += (seen.x[i] - seen.x[0]) * (seen.y[j] - seen.y[0]) -
            (seen.x[j] - seen.x[0]) * (seen.y[i] - seen.y[0]);
  }
  return area;
}

// Bounds in pixels, within `reach` of the picture. False if nothing is left.
bool find_bounds(const SplatCamera& camera, int reach, SeenTriangle& seen) {
  const auto pixel = [](std::int64_t at) { return static_cast<int>(at >> 8); };
  const auto corners = static_cast<std::ptrdiff_t>(seen.corners);
  const auto [left, right] = std::minmax_element(seen.x.begin(), seen.x.begin() + corners);
  const auto [top, bottom] = std::minmax_element(seen.y.begin(), seen.y.begin() + corners);
  seen.left_px = std::max(pixel(*left), -reach);
  seen.right_px = std::min(pixel(*right) + 1, camera.width + reach);
  seen.top_px = std::max(pixel(*top), -reach);
  seen.bottom_px = std::min(pixel(*bottom) + 1, camera.height + reach);
  return seen.left_px < seen.right_px && seen.top_px < seen.bottom_px;
}

bool see_triangle(const SplatCamera& camera, const RayMesh& mesh, SeenTriangle& seen) {
  const bool front = meets_front(mesh, seen.triangle, {glm::dvec3{0.0}, glm::dvec3{0.0}});
  if (!front && !mesh.draw.variant.two_sided) return false;
  seen.back = !front;
  const std::array<glm::dvec3, 3> corners = corner_positions(mesh, seen.triangle);
  const Polygon polygon = cut_near(corners, camera.near_m);
  if (polygon.corners < 3 || !find_inverse_depth(camera, corners, seen.inverse_depth)) return false;
  seen.corners = polygon.corners;
  seen.least_inverse = std::numeric_limits<double>::infinity();
  seen.most_inverse = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(polygon.corners); ++i) {
    const glm::dvec3 at = polygon.at[i];
    const double inverse = 1.0 / -at.z;
    seen.least_inverse = std::min(seen.least_inverse, inverse);
    seen.most_inverse = std::max(seen.most_inverse, inverse);
    seen.x[i] = snapped(camera.rays.centre_x + at.x * inverse / camera.rays.pixel_x);
    seen.y[i] = snapped(camera.rays.centre_y + at.y * inverse / camera.rays.pixel_y);
  }
  if (seen.most_inverse * camera.far_m < 1.0) return false;
  const std::int64_t area = twice_area(seen);
  if (area == 0) return false;
  if (area < 0) reverse(seen);
  const float radii[] = {camera.radius_px(seen.least_inverse), camera.radius_px(seen.most_inverse)};
  const float most = std::max(radii[0], radii[1]);
  const bool crosses_focus =
      seen.least_inverse <= camera.inverse_focus && camera.inverse_focus <= seen.most_inverse;
  seen.most_level = splat_level(most);
  seen.least_level = crosses_focus ? 0 : splat_level(std::min(radii[0], radii[1]));
  return find_bounds(camera, static_cast<int>(splat_reach_px(most)) + 1, seen);
}

}  // namespace

SplatCamera splat_camera(const LensViewInput& input) {
  const RayCamera rays =
      ray_camera(input.camera, input.focus_m, input.pinhole.width, input.pinhole.height);
  return {input.pinhole.width,
          input.pinhole.height,
          rays,
          input.scene.camera.near_m,
          input.scene.camera.far_m,
          input.aperture_radius_m / std::fabs(rays.pixel_y),
          1.0 / input.focus_m};
}

std::vector<SeenMesh> seen_meshes(const LensViewInput& input) {
  std::vector<SeenMesh> meshes;
  for (RayMesh& mesh : ray_meshes(input.scene, input.camera, input.frame)) {
    SpecularLight highlights = highlights_from(mesh, glm::vec3{input.camera.eye});
    meshes.push_back({std::move(mesh), std::move(highlights)});
  }
  return meshes;
}

std::vector<SeenTriangle> seen_triangles(const SplatCamera& camera,
                                         const std::vector<SeenMesh>& meshes) {
  std::vector<SeenTriangle> triangles;
  for (std::size_t surface = 0; surface < meshes.size(); ++surface) {
    const RayMesh& mesh = meshes[surface].mesh;
    const auto count = static_cast<std::uint32_t>(mesh.draw.input.mesh->indices.size() / 3);
    for (std::uint32_t triangle = 0; triangle < count; ++triangle) {
      SeenTriangle seen{};
      seen.surface = static_cast<std::uint32_t>(surface);
      seen.triangle = triangle;
      if (see_triangle(camera, mesh, seen)) triangles.push_back(seen);
    }
  }
  return triangles;
}

namespace {

// Alpha's halves are off by up to 2^-11 of themselves.
constexpr double kBehind = 1.0 + 0x1p-10;

// 3 standard deviations of a circle's Gaussian, in radii.
constexpr double kReachOfRadius = 1.55;

}  // namespace

Farthest farthest_of(const Image& pinhole) {
  Farthest farthest;
  Farthest::Level first{pinhole.width, pinhole.height, {}};
  for (int y = 0; y < pinhole.height; ++y) {
    for (int x = 0; x < pinhole.width; ++x) {
      first.depth_m.push_back(load_texel<Format::rgba16f>(pinhole, x, y).w);
    }
  }
  farthest.levels.push_back(std::move(first));
  while (farthest.levels.back().width > 1 || farthest.levels.back().height > 1) {
    const Farthest::Level& from = farthest.levels.back();
    Farthest::Level next{(from.width + 1) / 2, (from.height + 1) / 2, {}};
    for (int y = 0; y < next.height; ++y) {
      for (int x = 0; x < next.width; ++x) {
        float most = 0.0f;
        for (int i = 0; i < 4; ++i) {
          const int from_x = std::min(2 * x + i % 2, from.width - 1);
          const int from_y = std::min(2 * y + i / 2, from.height - 1);
          most =
              std::max(most, from.depth_m[static_cast<std::size_t>(from_y * from.width + from_x)]);
        }
        next.depth_m.push_back(most);
      }
    }
    farthest.levels.push_back(std::move(next));
  }
  return farthest;
}

bool is_hidden(const Farthest& farthest, double radius_per_inverse, double x, double y,
               double inverse_depth, int step) {
  const int width = farthest.levels[0].width, height = farthest.levels[0].height;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  if (column < 0 || row < 0 || column >= width || row >= height) return false;
  const auto is_behind = [&](float depth_m) {
    return inverse_depth * static_cast<double>(depth_m) * kBehind < 1.0;
  };
  const float seen_m = farthest.at(0, column, row);
  if (!is_behind(seen_m)) return false;
  const double apart =
      std::fabs(radius_per_inverse * (1.0 / static_cast<double>(seen_m) - inverse_depth));
  if (!(apart < static_cast<double>(kLargestMaxCoc))) return false;
  // A point of a wider lattice lies between pixels.
  const int reach = std::max(static_cast<int>(kReachOfRadius * apart + 0.5), step > 1 ? 1 : 0);
  const auto level = static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(2 * reach)));
  if (level >= farthest.levels.size()) return false;
  const int right = std::min(column + reach, width - 1) >> level;
  const int bottom = std::min(row + reach, height - 1) >> level;
  for (int at_y = std::max(row - reach, 0) >> level; at_y <= bottom; ++at_y) {
    for (int at_x = std::max(column - reach, 0) >> level; at_x <= right; ++at_x) {
      if (!is_behind(farthest.at(level, at_x, at_y))) return false;
    }
  }
  return true;
}

}  // namespace softfocus
