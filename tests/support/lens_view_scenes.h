#pragma once
// A square before black, as the tests of both references see it.

#include <cmath>
#include <string>

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/lens_views/lens_view_method.h"

namespace softfocus::test {

inline constexpr ThinLens kTestLens{.focal_length_mm = 50, .f_number = 0.2, .focus_m = 2.0};

/// A white, unlit square of `size_m`, facing the camera at `depth_m`, its centre on the axis.
inline Scene square_scene(double depth_m, double size_m) {
  Scene scene;
  scene.camera = {.position = {0, 0, depth_m},
                  .target = {0, 0, 0},
                  .fov_y_degrees = 40,
                  .near_m = 0.1,
                  .far_m = 50};
  Mesh mesh;
  mesh.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  Material material;
  material.lit = false;
  material.diffuse = glm::vec3{1.0f};
  scene.materials.push_back(material);
  Object object;
  object.scale = glm::dvec3{size_m};
  scene.objects.push_back(object);
  return scene;
}

/// The square with 4 x 4 fields. Every other field is a hole.
inline Scene lattice_scene(double depth_m, double size_m) {
  Scene scene = square_scene(depth_m, size_m);
  // Not along pixels' centres, where rounding decides.
  for (const glm::vec3& p : scene.meshes[0].positions) {
    scene.meshes[0].uvs.emplace_back(p.x + 0.53f, 0.54f - p.y);
  }
  Image fields = make_image(Format::rgba8, 4, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      store_texel(fields, x, y, glm::vec4{(x + y) % 2 == 0 ? 1.0f : 0.0f}, Profile{});
    }
  }
  scene.textures.push_back(make_texture(std::move(fields)));
  scene.materials[0].opacity_texture = 0;
  scene.materials[0].opacity_sampler = {Filter::nearest, Wrap::repeat, Wrap::repeat};
  scene.materials[0].cut_out = true;
  return scene;
}

struct Drawn {
  Image pinhole;
  SampledPicture sampled;
};

inline Drawn sample_scene(const Scene& scene, const char* method, const Sampling& sampling,
                          int width, int height, ThreadPool& pool,
                          const ThinLens& lens = kTestLens) {
  const Profile profile{};
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, width, height);
  Drawn drawn{draw_scene(scene, camera, 0.0, width, height, profile, pool), {}};
  drawn.sampled = find_lens_view_method(method)->render({scene,
                                                         camera,
                                                         0.0,
                                                         drawn.pinhole,
                                                         lens.focus_m,
                                                         aperture_radius_m(lens, 1.0),
                                                         sampling,
                                                         profile,
                                                         {}},
                                                        pool);
  return drawn;
}

/// Moments of red: sum, mean place and variances, in pixels.
struct Moments {
  double sum = 0.0, x = 0.0, y = 0.0, variance_x = 0.0, variance_y = 0.0;
};
inline Moments moments(const Image& picture) {
  Moments m;
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const double red = load_texel<Format::rgba16f>(picture, x, y).x;
        const double px = x + 0.5, py = y + 0.5;
        if (pass == 0) {
          m.sum += red;
          m.x += red * px;
          m.y += red * py;
        } else {
          m.variance_x += red * (px - m.x) * (px - m.x) / m.sum;
          m.variance_y += red * (py - m.y) * (py - m.y) / m.sum;
        }
      }
    }
    if (pass == 0) {
      m.x /= m.sum;
      m.y /= m.sum;
    }
  }
  return m;
}

/// A bright point's image has the aperture's shape, and the lens equation's radius to within 0.1
/// pixel. The second moments tell: r^2 / 4 for a uniform disc of radius r,
/// r^2 (2 + cos(2 pi / n)) / 12 for a regular polygon, plus that of the square that stands for the
/// point. Nothing lies outside.
inline void check_image_of_point(const char* method, double depth_m, int blades) {
  CAPTURE(std::string{method});
  CAPTURE(depth_m);
  CAPTURE(blades);
  constexpr int kSize = 128;
  constexpr double kPointPx = 1.0;
  const double tangent = std::tan(20.0 * 3.14159265358979323846 / 180.0);
  const Scene scene = square_scene(depth_m, kPointPx * 2.0 * depth_m * tangent / kSize);
  ThreadPool pool{2};
  const Drawn drawn =
      sample_scene(scene, method, {.samples = 4096, .aperture = {blades}}, kSize, kSize, pool);
  const double radius =
      std::fabs(coc_radius_px(pixel_coc(kTestLens, 40.0, kSize, 1.0), static_cast<float>(depth_m)));
  const double per_square =
      blades == 0 ? 0.25 : (2.0 + std::cos(2.0 * 3.14159265358979323846 / blades)) / 12.0;
  const Moments m = moments(drawn.sampled.picture);
  const double point = kPointPx * kPointPx / 12.0;
  const double found_x = std::sqrt((m.variance_x - point) / per_square);
  const double found_y = std::sqrt((m.variance_y - point) / per_square);
  MESSAGE(std::string{method} << " at " << depth_m << " m, blades " << blades << ": radius "
                              << radius << " px, found " << found_x << " and " << found_y);
  CHECK(radius > 5.0);
  CHECK(std::fabs(found_x - radius) < 0.1);
  CHECK(std::fabs(found_y - radius) < 0.1);
  CHECK(m.sum == doctest::Approx(kPointPx * kPointPx).epsilon(0.02));
  CHECK(std::fabs(m.x - kSize / 2.0) < 0.1);
  CHECK(std::fabs(m.y - kSize / 2.0) < 0.1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double distance = std::hypot(x + 0.5 - kSize / 2.0, y + 0.5 - kSize / 2.0);
      if (distance < radius + kPointPx) continue;
      CHECK(load_texel<Format::rgba16f>(drawn.sampled.picture, x, y).x == 0.0f);
    }
  }
}

}  // namespace softfocus::test
