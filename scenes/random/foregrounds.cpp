#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/vector_math.h"
#include "scenes/make/shapes.h"
#include "scenes/random/stage.h"

namespace softfocus {
namespace {

// A leaf of two triangles, folded along its middle, about a point.
void append_leaf(Mesh& mesh, glm::dvec3 at, glm::dvec3 along, glm::dvec3 across, double length) {
  const glm::dvec3 fold = normalize(cross(along, across));
  const glm::dvec3 tip = along * (0.5 * length);
  const glm::dvec3 side = across * (0.22 * length);
  const glm::dvec3 lift = fold * (0.08 * length);
  for (const double sign : {1.0, -1.0}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const glm::dvec3 edge = at + side * sign + lift;
    const glm::dvec3 normal = normalize(cross(edge - (at - tip), tip * 2.0)) * sign;
    for (const glm::dvec3& corner : {at - tip, edge, at + tip}) {
      mesh.positions.emplace_back(corner);
      mesh.normals.emplace_back(normal);
    }
    const std::uint32_t second = sign > 0.0 ? first + 1 : first + 2;
    mesh.indices.insert(mesh.indices.end(), {first, second, 2 * first + 3 - second});
  }
}

glm::dvec3 any_direction(Stage& stage) {
  for (;;) {
    const double x = between(stage, -1.0, 1.0);
    const double y = between(stage, -1.0, 1.0);
    const glm::dvec3 v{x, y, between(stage, -1.0, 1.0)};
    const double square = dot(v, v);
    if (square > 0.01 && square < 1.0) return normalize(v);
  }
}

}  // namespace

double add_fence(Stage& stage) {
  const double depth = stage.subject_m * between(stage, 0.32, 0.7);
  const double width = pixels_at(stage, log_between(stage, 3.0, 40.0), depth);
  const double spacing = width * log_between(stage, 2.5, 8.0);
  const double half_height = stage.tangent * depth;
  const double half_width = 1.8 * half_height;
  const double lean = happens(stage, 0.4) ? between(stage, -60.0, 60.0) : 0.0;
  const std::uint32_t cube = add_mesh(stage, make_cube(1.0, 2));
  const std::uint32_t bar = any_material(stage, {false, 1});
  // All over the picture, or from its edge to somewhere.
  const double from = happens(stage, 0.5) ? -half_width : between(stage, -0.8, 0.3) * half_height;
  const int count = std::min(static_cast<int>((half_width - from) / spacing), 90);
  const glm::dvec3 middle = seen_at(stage, {0.0, 0.0}, depth);
  for (int i = 0; i < count; ++i) {
    add_object(stage, cube, bar,
               {.position = middle + stage.right * (from + spacing * i),
                .rotation_degrees = {0.0, 0.0, lean},
                .scale = {width, 8.0 * half_height, 0.5 * width}});
  }
  if (happens(stage, 0.5)) {
    const int rails = count_between(stage, 1, 12);
    for (int i = 0; i < rails; ++i) {
      const double y = half_height * (2.0 * (i + 0.5) / rails - 1.0);
      add_object(stage, cube, bar,
                 {.position = middle + stage.right * (0.5 * (from + half_width)) + stage.up * y,
                  .scale = {half_width - from, width, 0.4 * width}});
    }
  }
  reach_to(stage, depth - 0.4 * half_height);
  return depth - 0.25 * width;
}

double add_foliage(Stage& stage) {
  const double nearest = stage.subject_m * between(stage, 0.3, 0.5);
  const double farthest = nearest * between(stage, 1.1, 2.0);
  std::array<Mesh, 3> meshes;
  const int count = count_between(stage, 80, 420);
  const double length = pixels_at(stage, log_between(stage, 30.0, 120.0), nearest);
  // Twigs hang in a few clusters; the largest may cover the subject in part.
  std::array<glm::dvec2, 5> clusters{};
  for (glm::dvec2& cluster : clusters) {
    const double x = between(stage, -1.3, 1.3);
    cluster = {x, between(stage, -0.9, 1.1)};
  }
  const double spread = between(stage, 0.2, 0.6);
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 cluster = clusters[next_bits(stage.random) % clusters.size()];
    const double x = cluster.x + between(stage, -spread, spread);
    const glm::dvec2 place{x, cluster.y + between(stage, -spread, spread)};
    const glm::dvec3 at = seen_at(stage, place, between(stage, nearest, farthest));
    const glm::dvec3 along = any_direction(stage);
    const glm::dvec3 across = normalize(cross(along, any_direction(stage)));
    Mesh& mesh = meshes[next_bits(stage.random) % meshes.size()];
    append_leaf(mesh, at, along, across, length * between(stage, 0.6, 1.0));
  }
  for (Mesh& mesh : meshes) {
    if (mesh.indices.empty()) continue;
    Material leaf;
    leaf.two_sided = true;
    const auto green = static_cast<float>(between(stage, 0.15, 0.6));
    leaf.diffuse = {green * static_cast<float>(between(stage, 0.3, 1.1)), green,
                    green * static_cast<float>(between(stage, 0.05, 0.4))};
    leaf.ambient = leaf.diffuse;
    leaf.specular = glm::vec3{0.2f};
    const std::uint32_t material = add_material(stage, leaf);
    add_object(stage, add_mesh(stage, std::move(mesh)), material, {});
  }
  reach_to(stage, nearest - length);
  return 0.0;
}

double add_near_things(Stage& stage) {
  const int count = count_between(stage, 1, 3);
  const std::uint32_t ball = add_mesh(stage, make_sphere(1.0, 48, 24));
  double middle = stage.subject_m;
  for (int i = 0; i < count; ++i) {
    const double depth = stage.subject_m * between(stage, 0.35, 0.65);
    const double radius = stage.tangent * depth * between(stage, 0.15, 0.45);
    const double side = (i % 2 == 0 ? 1.0 : -1.0) * between(stage, 0.5, 1.0);
    const glm::dvec2 place{side, between(stage, -0.9, 0.6)};
    const glm::dvec3 rotation = any_rotation(stage);
    const bool textured = happens(stage, 0.5);
    const std::uint32_t material = any_material(stage, {textured, 8});
    add_object(stage, ball, material,
               {.position = seen_at(stage, place, depth),
                .rotation_degrees = rotation,
                .scale = glm::dvec3{radius}});
    reach_to(stage, depth - radius);
    middle = depth - 0.9 * radius;
  }
  return middle;
}

}  // namespace softfocus
