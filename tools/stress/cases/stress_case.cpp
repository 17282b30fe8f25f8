#include "tools/stress/cases/stress_case.h"

#include <algorithm>
#include <cmath>

#include "raster/numbers/exact_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/make/procedural_texture.h"

namespace softfocus {
namespace {

constexpr double kFovDegrees = 40.0;

/// Metres that a picture of `size_px` rows sees of a pixel at a depth of 1 m.
double metres_per_pixel(int size_px) {
  return 2.0 * exact_math::tan_degrees(kFovDegrees / 2.0) / size_px;
}

}  // namespace

double depth_of_radius(double radius_px, double radius_at_infinity_px, double focus_m) {
  return focus_m / (1.0 - radius_px / radius_at_infinity_px);
}

DofSettings uncut_settings(double radius_at_infinity_px, double focus_m, double largest_px) {
  // Depths are rounded to halves: a circle may be larger by a thousandth.
  return {.coc = {static_cast<float>(radius_at_infinity_px), static_cast<float>(focus_m)},
          .max_coc_px = static_cast<float>(largest_px + 0.5)};
}

Scene flat_scene() {
  Scene scene;
  scene.camera = {.position = {0, 0, 0},
                  .target = {0, 0, -1},
                  .fov_y_degrees = kFovDegrees,
                  .near_m = 0.05,
                  .far_m = 200.0};
  Mesh mesh;
  mesh.positions = {{0, -1, 0}, {1, -1, 0}, {1, 0, 0}, {0, 0, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  return scene;
}

void add_rectangle(Scene& scene, int size_px, const PixelBox& box, double depth_m, glm::vec3 colour,
                   std::optional<std::uint32_t> texture, glm::vec2 repeats) {
  Material material;
  material.diffuse = colour;
  material.texture = texture;
  material.lit = false;
  scene.materials.push_back(material);
  Object object;
  if (repeats != glm::vec2{1, 1}) {
    Mesh mesh = scene.meshes.front();
    for (glm::vec2& uv : mesh.uvs) uv *= repeats;
    scene.meshes.push_back(mesh);
    object.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  }
  object.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  const double scale = metres_per_pixel(size_px) * depth_m;
  object.position = {(box.left - size_px / 2.0) * scale, (size_px / 2.0 - box.top) * scale,
                     -depth_m};
  object.scale = {(box.right - box.left) * scale, (box.bottom - box.top) * scale, 1.0};
  scene.objects.push_back(object);
}

void add_backdrop(Scene& scene, int size_px, double depth_m, glm::vec3 colour,
                  std::optional<std::uint32_t> texture, float repeats) {
  const double size = size_px;
  add_rectangle(scene, size_px, {-size, -size, 2.0 * size, 2.0 * size}, depth_m, colour, texture,
                {repeats, repeats});
}

std::uint32_t add_pattern(Scene& scene, std::string_view pattern, int cells, glm::vec3 first,
                          glm::vec3 second) {
  const TextureRecipe recipe{.size = 256, .cells = cells, .colours = {first, second}};
  scene.textures.push_back(make_procedural_texture(*find_texture_pattern(pattern), recipe));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

StressFrame drawn_frame(Scene scene, double radius_at_infinity_px, double largest_px, int size_px,
                        ThreadPool& pool, double focus_m, int samples) {
  StressFrame frame;
  frame.settings = uncut_settings(radius_at_infinity_px, focus_m, largest_px);
  StressScene with{std::move(scene), {}, focus_m, 0.0};
  with.camera = camera_matrices(with.scene.camera, 0.0, size_px, size_px);
  // dof/lens.h, solved for the aperture.
  with.aperture_m = radius_at_infinity_px * focus_m * metres_per_pixel(size_px);
  if (samples == 1) {
    frame.sharp = draw_scene(with.scene, with.camera, 0.0, size_px, size_px, Profile{}, pool);
  } else {
    PreparedScene prepared = prepare_scene(with.scene, Profile{}, pool);
    FrameParts parts;
    draw_parts(prepared, with.camera, 0.0, size_px, size_px, 1, parts, pool, {}, samples);
    frame.sharp = std::move(parts.opaque);
    frame.edges = std::move(parts.edges);
  }
  frame.scene = std::move(with);
  return frame;
}

StressTrial single(StressFrame frame) {
  StressTrial trial;
  trial.frames.push_back(std::move(frame));
  return trial;
}

std::vector<StressCase> stress_cases() {
  std::vector<StressCase> all;
  for (const auto cases :
       {edge_cases(), light_cases(), crowd_cases(), glass_cases(), plane_cases(), depth_cases(),
        plain_cases(), motion_cases(), shutter_cases(), shadow_cases(), relief_cases()}) {
    all.insert(all.end(), cases.begin(), cases.end());
  }
  return all;
}

double shown_severity(const StressCase& of, std::span<const double> severities) {
  return *std::min_element(severities.begin(), severities.end(), [&](double a, double b) {
    return std::fabs(a - of.telling) < std::fabs(b - of.telling);
  });
}

std::vector<double> severities_of(const StressCase& of, int size_px, bool quick) {
  std::vector<double> fitting;
  for (const double severity : of.severities) {
    if (of.parameter.unit != "px" || severity <= size_px / 4.0) fitting.push_back(severity);
  }
  if (!quick) return fitting;
  std::vector<double> some{fitting.front(), shown_severity(of, fitting), fitting.back()};
  some.erase(std::unique(some.begin(), some.end()), some.end());
  return some;
}

bool same_trials(const StressCase& a, const StressCase& b) {
  return a.make == b.make && a.views == b.views && a.telling == b.telling &&
         std::equal(a.severities.begin(), a.severities.end(), b.severities.begin(),
                    b.severities.end());
}

}  // namespace softfocus
