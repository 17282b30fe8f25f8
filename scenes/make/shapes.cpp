#include "scenes/make/shapes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/vec2.hpp>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"
#include "scenes/make/grid_mesh.h"
#include "scenes/make/procedural_texture.h"

namespace softfocus {
namespace {

using exact_math::cos_degrees;
using exact_math::sin_degrees;

// The horizontal direction at a column of a full turn; +z first, then +x. The last
// column has the bits of the first: 360 degrees reduce to 0 exactly.
glm::dvec3 heading(double column, int columns) {
  const double degrees = 360.0 * column / columns;
  return {sin_degrees(degrees), 0.0, cos_degrees(degrees)};
}

// -0.5 to 0.5 over the cells; opposite places differ in sign alone, so that faces
// that meet agree to the bit.
double centred(double place, int cells) { return (2.0 * place - cells) / (2.0 * cells); }

constexpr glm::dvec3 kUp{0.0, 1.0, 0.0};

}  // namespace

Mesh make_sphere(double radius, int segments, int rings) {
  assert(radius > 0.0 && segments >= 3 && rings >= 2);
  Mesh mesh;
  append_grid(mesh, {segments, rings, true, true}, [&](double column, int row) {
    const double from_pole = 180.0 * row / rings;
    const glm::dvec3 out =
        heading(column, segments) * sin_degrees(from_pole) + kUp * cos_degrees(from_pole);
    return SurfacePoint{out * radius, out, {column / segments, static_cast<double>(row) / rings}};
  });
  return mesh;
}

Mesh make_torus(double ring_radius, double tube_radius, int segments, int sides) {
  assert(tube_radius > 0.0 && tube_radius < ring_radius && segments >= 3 && sides >= 3);
  Mesh mesh;
  append_grid(mesh, {segments, sides}, [&](double column, int row) {
    const double around_tube = 360.0 * row / sides;
    const glm::dvec3 ring = heading(column, segments);
    const glm::dvec3 out = ring * sin_degrees(around_tube) + kUp * cos_degrees(around_tube);
    return SurfacePoint{ring * ring_radius + out * tube_radius,
                        out,
                        {column / segments, static_cast<double>(row) / sides}};
  });
  return mesh;
}

Mesh make_cone(double radius, double height, int segments, int rings) {
  assert(radius > 0.0 && height > 0.0 && segments >= 3 && rings >= 1);
  const double slant = std::sqrt(radius * radius + height * height);
  Mesh mesh;
  append_grid(mesh, {segments, rings, true, false}, [&](double column, int row) {
    const double down = static_cast<double>(row) / rings;
    const glm::dvec3 out = heading(column, segments);
    return SurfacePoint{out * (radius * down) + kUp * (height * (rings - row) / rings),
                        (out * height + kUp * radius) / slant,
                        {column / segments, down}};
  });
  append_grid(mesh, {segments, 1, false, true}, [&](double column, int row) {
    const glm::dvec3 rim = row == 0 ? heading(column, segments) : glm::dvec3{0.0};
    return SurfacePoint{rim * radius, -kUp, {0.5 + 0.5 * rim.x, 0.5 - 0.5 * rim.z}};
  });
  return mesh;
}

Mesh make_cube(double size, int cells) {
  assert(size > 0.0 && cells >= 1);
  struct Face {
    glm::dvec3 outward;
    glm::dvec3 right;
    glm::dvec3 up;
  };
  // outward = right x up
  static constexpr std::array<Face, 6> kFaces = {{
      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
      {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
      {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}},
      {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
  }};
  Mesh mesh;
  for (const Face& face : kFaces) {
    append_grid(mesh, {cells, cells}, [&](double column, int row) {
      const glm::dvec3 place =
          face.outward * 0.5 + face.right * centred(column, cells) - face.up * centred(row, cells);
      return SurfacePoint{
          place * size, face.outward, {column / cells, static_cast<double>(row) / cells}};
    });
  }
  return mesh;
}

Mesh make_plane(double width, double depth, int cells_x, int cells_z) {
  assert(width > 0.0 && depth > 0.0 && cells_x >= 1 && cells_z >= 1);
  Mesh mesh;
  append_grid(mesh, {cells_x, cells_z}, [&](double column, int row) {
    return SurfacePoint{{centred(column, cells_x) * width, 0.0, centred(row, cells_z) * depth},
                        kUp,
                        {column / cells_x, static_cast<double>(row) / cells_z}};
  });
  return mesh;
}

Mesh inside_out(Mesh mesh) {
  for (glm::vec3& normal : mesh.normals) normal = -normal;
  for (glm::vec2& uv : mesh.uvs) uv.x = 1.0f - uv.x;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  }
  return mesh;
}

void repeat_uvs(Mesh& mesh, glm::dvec2 times) {
  for (glm::vec2& uv : mesh.uvs) uv = glm::vec2{glm::dvec2{uv} * times};
}

namespace {

bool too_near(const Ball& a, const Ball& b, double gap) {
  const glm::dvec3 between = a.centre - b.centre;
  const double least = a.radius + b.radius + gap;
  return dot(between, between) < least * least;
}

}  // namespace

std::optional<std::vector<Ball>> place_balls(const BallRule& rule,
                                             const std::vector<Ball>& obstacles) {
  RandomSequence random{rule.seed};
  std::vector<Ball> balls;
  for (int i = 0; i < rule.count; ++i) {
    Ball ball;
    ball.radius = next_between(random, rule.radius_min, rule.radius_max);
    const auto is_taken = [&](const Ball& other) { return too_near(ball, other, rule.gap); };
    int attempt = 0;
    do {
      if (attempt++ == kBallAttempts) return std::nullopt;
      ball.centre.x = next_between(random, rule.region_min.x, rule.region_max.x);
      ball.centre.y = next_between(random, rule.region_min.y, rule.region_max.y);
      ball.centre.z = next_between(random, rule.region_min.z, rule.region_max.z);
      if (rule.on_ground) ball.centre.y = rule.region_min.y + ball.radius;
    } while (std::any_of(obstacles.begin(), obstacles.end(), is_taken) ||
             std::any_of(balls.begin(), balls.end(), is_taken));
    balls.push_back(ball);
  }
  return balls;
}

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
