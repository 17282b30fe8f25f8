#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/make/shapes.h"
#include "scenes/make/teapot.h"
#include "scenes/random/stage.h"

namespace softfocus {
namespace {

// A shape about one unit high that stands on y = 0.
struct StandingShape {
  Mesh mesh;
  double middle = 0.5;  // the height of its own origin
};

StandingShape any_shape(Stage& stage, bool fine) {
  const int cuts = fine ? 2 : 1;
  switch (count_between(stage, 0, 4)) {
    case 0: return {make_sphere(0.5, 24 * cuts, 12 * cuts)};
    case 1: return {make_torus(0.36, between(stage, 0.06, 0.14), 32 * cuts, 12 * cuts)};
    case 2: return {make_cone(0.4, 1.0, 24 * cuts, 8 * cuts), 0.0};
    case 3: return {make_cube(0.7, 4)};
    default:
      return fine ? StandingShape{make_teapot(0.9, 10), 0.0}
                  : StandingShape{make_sphere(0.5, 24, 12)};
  }
}

glm::dvec2 any_place(Stage& stage, double widest) {
  const double x = between(stage, -widest, widest);
  return {x, between(stage, -1.0, 1.0)};
}

}  // namespace

void add_still_life(Stage& stage) {
  const int count = count_between(stage, 1, 3);
  for (int i = 0; i < count; ++i) {
    StandingShape shape = any_shape(stage, true);
    repeat_uvs(shape.mesh, {2.0, 2.0});
    // The first stands in the middle, in focus; the others beside and behind or before it.
    const double height = stage.subject_height * (i == 0 ? 1.0 : between(stage, 0.4, 1.0));
    const double side = i == 0 ? 0.0 : (i == 1 ? 1.0 : -1.0) * between(stage, 0.8, 1.4);
    const double depth = stage.subject_m * (i == 0 ? 1.0 : log_between(stage, 0.75, 1.8));
    const double turn = between(stage, 0.0, 360.0);
    const std::uint32_t material = any_material(stage, {happens(stage, 0.6), 6});
    add_object(stage, add_mesh(stage, std::move(shape.mesh)), material,
               {.position = {side * stage.subject_height, height * shape.middle, -depth},
                .rotation_degrees = {0.0, turn, 0.0},
                .scale = glm::dvec3{height}});
    reach_to(stage, depth - height);
  }
}

void add_bust(Stage& stage) {
  const double h = stage.subject_height;
  const std::uint32_t ball = add_mesh(stage, make_sphere(1.0, 48, 24));
  Material skin;
  const auto tone = static_cast<float>(between(stage, 0.15, 0.8));
  skin.diffuse = skin.ambient = glm::vec3{tone, 0.72f * tone, 0.56f * tone};
  skin.specular = glm::vec3{0.15f};
  const std::uint32_t face = add_material(stage, skin);
  Material strands = skin;
  strands.diffuse = strands.ambient = any_colour(stage, 0.4);
  strands.specular = glm::vec3{0.6f};
  const std::uint32_t hair = add_material(stage, strands);
  const std::uint32_t cloth = any_material(stage, {true, 12});
  Material dark;
  dark.diffuse = dark.ambient = glm::vec3{0.02f};
  dark.specular = glm::vec3{1.5f};
  dark.shininess = 120;
  const std::uint32_t eye = add_material(stage, dark);
  const double turn = between(stage, -0.05, 0.05) * h;
  const auto part = [&](std::uint32_t material, glm::dvec3 place, glm::dvec3 size) {
    add_object(
        stage, ball, material,
        {.position = {h * place.x, h * place.y, h * place.z - stage.subject_m}, .scale = size * h});
  };
  part(cloth, {0.0, 0.08, 0.0}, {0.52, 0.26, 0.22});
  part(face, {0.0, 0.36, 0.0}, {0.11, 0.16, 0.11});
  part(face, {0.0, 0.66, 0.02}, {0.2, 0.27, 0.21});
  part(hair, {0.0, 0.74, -0.05}, {0.235, 0.25, 0.22});
  part(face, {turn / h, 0.63, 0.23}, {0.03, 0.06, 0.04});
  part(eye, {-0.08 + turn / h, 0.68, 0.195}, {0.026, 0.02, 0.02});
  part(eye, {0.08 + turn / h, 0.68, 0.195}, {0.026, 0.02, 0.02});
  // Single hairs against what is behind.
  const std::uint32_t rod = add_mesh(stage, make_cube(1.0, 2));
  const int hairs = count_between(stage, 6, 24);
  for (int i = 0; i < hairs; ++i) {
    const double x = between(stage, -0.22, 0.22);
    add_object(stage, rod, hair,
               {.position = {h * x, h * (0.94 - 1.5 * x * x), -0.05 * h - stage.subject_m},
                .rotation_degrees = {0.0, 0.0, -120.0 * x + between(stage, -25.0, 25.0)},
                .scale = {pixels_at(stage, 2.0, stage.subject_m), 0.16 * h,
                          pixels_at(stage, 2.0, stage.subject_m)}});
  }
  reach_to(stage, stage.subject_m - 0.6 * h);
}

void add_blocks(Stage& stage, int count) {
  const std::uint32_t cube = add_mesh(stage, make_cube(1.0, 6));
  const std::array<std::uint32_t, 3> materials{any_material(stage, {true, 8}),
                                               any_material(stage, {true, 4}),
                                               any_material(stage, {false, 1})};
  for (int i = 0; i < count; ++i) {
    const double farthest = std::min(5.0, 0.9 * stage.backdrop_m / stage.subject_m);
    const double depth = stage.subject_m * log_between(stage, 1.25, std::max(farthest, 1.3));
    const double half_width = 1.2 * stage.tangent * depth;
    const double x = between(stage, -half_width, half_width);
    const glm::dvec3 size =
        glm::dvec3{between(stage, 0.15, 0.5), between(stage, 0.2, 1.1), between(stage, 0.1, 0.3)} *
        stage.subject_height;
    const double turn = between(stage, 0.0, 90.0);
    const std::uint32_t material = one_of(stage, materials);
    add_object(stage, cube, material,
               {.position = {x, 0.5 * size.y, -depth},
                .rotation_degrees = {0.0, turn, 0.0},
                .scale = size});
  }
}

void add_clutter(Stage& stage, int count, double nearest, double farthest) {
  std::array<std::uint32_t, 4> meshes{};
  for (std::uint32_t& mesh : meshes) mesh = add_mesh(stage, any_shape(stage, false).mesh);
  std::array<std::uint32_t, 5> materials{};
  for (std::size_t i = 0; i < materials.size(); ++i) {
    materials[i] = any_material(stage, {i == 0, 4});
  }
  const double last = std::min(farthest * stage.subject_m, 0.9 * stage.backdrop_m);
  for (int i = 0; i < count; ++i) {
    // Even in 1 / depth, and so in the radius of the circle of confusion.
    const double depth = 1.0 / between(stage, 1.0 / last, 1.0 / (nearest * stage.subject_m));
    const double size = pixels_at(stage, log_between(stage, 12.0, 110.0), depth);
    const glm::dvec2 place = any_place(stage, 1.6);
    const std::uint32_t mesh = one_of(stage, meshes);
    const std::uint32_t material = one_of(stage, materials);
    const glm::dvec3 rotation = any_rotation(stage);
    add_object(stage, mesh, material,
               {.position = seen_at(stage, place, depth),
                .rotation_degrees = rotation,
                .scale = glm::dvec3{size}});
    reach_to(stage, depth - size);
  }
}

void add_lamps(Stage& stage, int count) {
  const std::uint32_t ball = add_mesh(stage, make_sphere(1.0, 16, 8));
  std::array<std::uint32_t, 6> materials{};
  for (std::uint32_t& material : materials) {
    Material lamp;
    lamp.lit = false;
    const auto light = static_cast<float>(log_between(stage, 1.0, 100.0));
    const double tint = between(stage, 0.0, 0.6);
    lamp.diffuse = light * glm::vec3{1.0, 1.0 - 0.5 * tint, 1.0 - tint};
    if (happens(stage, 0.3)) lamp.diffuse = {lamp.diffuse.z, lamp.diffuse.y, lamp.diffuse.x};
    material = add_material(stage, lamp);
  }
  const double last = 0.95 * stage.backdrop_m / stage.subject_m;
  for (int i = 0; i < count; ++i) {
    const bool before = happens(stage, 0.12);
    const double depth = stage.subject_m * (before ? between(stage, 0.45, 0.8)
                                                   : log_between(stage, 1.2, std::max(1.3, last)));
    const double radius = pixels_at(stage, log_between(stage, 1.5, before ? 4.0 : 9.0), depth);
    const glm::dvec2 place = any_place(stage, 1.4);
    const std::uint32_t material = one_of(stage, materials);
    add_object(
        stage, ball, material,
        {.position = seen_at(stage, {place.x, before ? place.y : 0.4 + 0.6 * place.y}, depth),
         .scale = glm::dvec3{radius}});
    reach_to(stage, depth - radius);
  }
}

void add_bright_edges(Stage& stage, int count) {
  const std::uint32_t ring = add_mesh(stage, make_torus(1.0, 0.06, 48, 12));
  const std::uint32_t rod = add_mesh(stage, make_sphere(1.0, 24, 24));
  std::array<std::uint32_t, 3> materials{};
  for (std::uint32_t& material : materials) {
    Material metal;
    metal.diffuse = metal.ambient = any_colour(stage, 0.3);
    metal.specular = glm::vec3{static_cast<float>(log_between(stage, 5.0, 100.0))};
    metal.shininess = count_between(stage, 40, 400);
    material = add_material(stage, metal);
  }
  const double last = std::min(4.0, 0.9 * stage.backdrop_m / stage.subject_m);
  for (int i = 0; i < count; ++i) {
    const double depth = stage.subject_m / between(stage, 1.0 / last, 1.0 / 0.5);
    const double size = pixels_at(stage, log_between(stage, 30.0, 160.0), depth);
    const bool is_ring = happens(stage, 0.6);
    const glm::dvec2 place = any_place(stage, 1.3);
    const glm::dvec3 thin{0.05, 1.0, 0.05};
    const std::uint32_t material = one_of(stage, materials);
    const glm::dvec3 rotation = any_rotation(stage);
    add_object(stage, is_ring ? ring : rod, material,
               {.position = seen_at(stage, place, depth),
                .rotation_degrees = rotation,
                .scale = (is_ring ? glm::dvec3{1.0} : thin) * size});
    reach_to(stage, depth - 1.06 * size);
  }
}

}  // namespace softfocus
