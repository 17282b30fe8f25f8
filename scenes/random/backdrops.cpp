#include <algorithm>

#include "scenes/make/shapes.h"
#include "scenes/random/stage.h"

namespace softfocus {
namespace {

// The backdrop is seen whole in a picture so many times as wide as high.
constexpr double kWidest = 2.5;

}  // namespace

void add_wall(Stage& stage) {
  const double depth = stage.subject_m * log_between(stage, 1.5, 7.0);
  const double width = 2.0 * kWidest * stage.tangent * depth + 2.0 * stage.subject_m;
  // Turned, it comes nearer at one side; the subject stays before it.
  const bool turns = depth > 3.5 * stage.subject_m;
  const double turn = turns ? between(stage, -20.0, 20.0) : 0.0;
  Mesh mesh = make_plane(width, width, 24, 24);
  const double repeats = log_between(stage, 2.0, 12.0);
  repeat_uvs(mesh, {repeats, repeats});
  const std::uint32_t material = any_material(stage, {true, count_between(stage, 1, 6) * 2, 256});
  add_object(stage, add_mesh(stage, std::move(mesh)), material,
             {.position = {0.0, 0.0, -depth}, .rotation_degrees = {90.0, turn, 0.0}});
  stage.backdrop_m = turns ? 0.55 * depth : depth;
}

void add_room(Stage& stage) {
  const double depth = stage.subject_m * between(stage, 1.5, 3.5);
  const double width = 2.0 * stage.tangent * depth * between(stage, 0.8, 1.6);
  const double height =
      std::max(width * between(stage, 0.6, 1.0), 1.5 * stage.scene.camera.position.y);
  // Its front wall is behind the camera.
  const double behind = 0.5 * stage.subject_m;
  Mesh mesh = inside_out(make_cube(1.0, 16));
  const double repeats = log_between(stage, 1.0, 6.0);
  repeat_uvs(mesh, {repeats, repeats});
  const std::uint32_t material = any_material(stage, {true, count_between(stage, 1, 5) * 2, 256});
  add_object(stage, add_mesh(stage, std::move(mesh)), material,
             {.position = {0.0, 0.5 * height - 0.001 * height, 0.5 * (behind - depth)},
              .scale = {std::max(width, stage.subject_m), height, depth + behind}});
  stage.backdrop_m = 0.95 * depth;
}

void add_sky(Stage& stage) {
  stage.scene.background = any_colour(stage, 1.0);
  stage.backdrop_m = 12.0 * stage.subject_m;
}

void add_night(Stage& stage) {
  stage.scene.background = any_colour(stage, 0.03);
  stage.scene.ambient_light = glm::vec3{0.08f};
  for (Light& light : stage.scene.lights) light.colour *= 0.35f;
  stage.backdrop_m = 12.0 * stage.subject_m;
}

void add_floor(Stage& stage, double fields_a_metre) {
  const double size = 50.0 * stage.subject_m;
  const int cells = 8;
  Mesh mesh = make_plane(size, size, 64, 64);
  const double repeats = size / stage.subject_m * fields_a_metre / cells;
  repeat_uvs(mesh, {repeats, repeats});
  const std::uint32_t material = any_material(stage, {true, cells, 256});
  add_object(stage, add_mesh(stage, std::move(mesh)), material,
             {.position = {0.0, 0.0, -0.4 * size}});
  // Where the lower edge of the picture meets it.
  reach_to(stage, stage.scene.camera.position.y / (stage.up.y * stage.tangent - stage.forwards.y));
}

}  // namespace softfocus
