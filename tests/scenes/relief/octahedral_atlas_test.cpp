#include "scenes/relief/impostors/octahedral_atlas.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "scenes/make/shapes.h"
#include "tests/support/relief_scenes.h"

using namespace softfocus;

namespace {

constexpr int kSize = 48;
constexpr float kFar = 100.0f;

CameraMatrices seen_from(glm::dvec3 eye) {
  Camera camera;
  camera.position = eye;
  camera.target = glm::dvec3{0.0};
  return camera_matrices(camera, 0.0, kSize, kSize);
}

Image cleared() {
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  clear_image(picture, {0.0f, 0.0f, 0.0f, kFar}, Profile{});
  return picture;
}

Image shown_by(const OctahedralAtlas& atlas, const CameraMatrices& camera, int steps,
               int threads = 2) {
  ThreadPool pool(threads);
  Image picture = cleared();
  draw_octahedral(atlas, camera, steps, picture, pool);
  return picture;
}

OctahedralAtlas atlas_of(const Scene& scene, const OctahedralForm& form) {
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  return make_octahedral_atlas(maker, form, pool);
}

/// Pixels that one shows and the other does not.
int wrong_pixels(const Image& shown, const Scene& scene, const CameraMatrices& camera) {
  ThreadPool pool(2);
  const Image drawn = draw_scene(scene, camera, 0.0, kSize, kSize, Profile{}, pool);
  int wrong = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const bool is_drawn = load_texel(drawn, x, y).w < 10.0f;
      wrong += is_drawn != (load_texel(shown, x, y).w < 10.0f) ? 1 : 0;
    }
  }
  return wrong;
}

/// The mean error of depth of pixels that both show.
double depth_error(const Image& shown, const Scene& scene, const CameraMatrices& camera) {
  ThreadPool pool(2);
  const Image drawn = draw_scene(scene, camera, 0.0, kSize, kSize, Profile{}, pool);
  double sum = 0.0;
  int pixels = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float own = load_texel(shown, x, y).w, right = load_texel(drawn, x, y).w;
      if (own > 10.0f || right > 10.0f) continue;
      sum += std::fabs(static_cast<double>(own - right));
      ++pixels;
    }
  }
  return sum / pixels;
}

}  // namespace

TEST_CASE("a direction comes back from its place on the octahedron's square") {
  for (int i = 0; i < 300; ++i) {
    const double turn = 0.7 * i, height = -1.0 + i / 150.0;
    const double across = std::sqrt(std::fmax(0.0, 1.0 - height * height));
    const glm::dvec3 direction{across * std::cos(turn), height, across * std::sin(turn)};
    for (const bool hemisphere : {false, true}) {
      if (hemisphere && height < 0.0) continue;
      const glm::dvec2 place = octahedral_place(direction * 3.0, hemisphere);
      CHECK(std::fmax(std::fabs(place.x - 0.5), std::fabs(place.y - 0.5)) <= 0.5);
      const glm::dvec3 off = octahedral_direction(place, hemisphere) - direction;
      CHECK(dot(off, off) < 1e-28);
    }
  }
}

TEST_CASE("up is the middle of the square, and a hemisphere's rim is its border") {
  CHECK(octahedral_place({0.0, 2.0, 0.0}, false) == glm::dvec2{0.5, 0.5});
  CHECK(octahedral_place({0.0, 2.0, 0.0}, true) == glm::dvec2{0.5, 0.5});
  const glm::dvec2 rim = octahedral_place({0.6, 0.0, 0.2}, true);
  CHECK(std::fmax(rim.x, rim.y) == 1.0);
  CHECK(octahedral_place({0.6, -0.9, 0.2}, true) == rim);
}

TEST_CASE("shares of a view sum to one, and all weight is the view's own where one was drawn") {
  const OctahedralAtlas atlas{5, false, glm::dvec3{0.0}, 1.0, {}};
  const OctahedralBlend own = octahedral_blend(atlas, octahedral_direction({0.25, 0.75}, false));
  double most = 0.0;
  std::size_t of = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (own.shares[i] > most) of = own.pictures[i];
    most = std::fmax(most, own.shares[i]);
  }
  CHECK(most > 1.0 - 1e-12);
  CHECK(of == 3 * 5 + 1);
  const OctahedralBlend other = octahedral_blend(atlas, {0.3, -0.2, 0.9});
  CHECK(std::fabs(other.shares[0] + other.shares[1] + other.shares[2] - 1.0) < 1e-15);
  CHECK(*std::min_element(other.shares.begin(), other.shares.end()) >= 0.0);
}

TEST_CASE("an atlas shows a sphere as it is drawn, but for pixels at its outline") {
  const Scene scene = test::lit_mesh(make_sphere(0.8, 64, 32));
  const OctahedralAtlas atlas = atlas_of(scene, {.views = 16, .texels = 48});
  for (const glm::dvec3 eye :
       {glm::dvec3{0.4, 1.0, 2.6}, glm::dvec3{0.0, 3.0, 0.1}, glm::dvec3{-2.0, -2.0, 0.3}}) {
    const CameraMatrices camera = seen_from(eye);
    const Image shown = shown_by(atlas, camera, 1);
    CHECK(wrong_pixels(shown, scene, camera) < 60);
    // The nearest point, on the axis.
    CHECK(std::fabs(static_cast<double>(load_texel(shown, kSize / 2, kSize / 2).w) -
                    (std::sqrt(dot(eye, eye)) - 0.8)) < 0.02);
  }
}

TEST_CASE("each step of parallax brings a ring's depths nearer to where they are") {
  const Scene scene = test::lit_mesh(make_torus(0.7, 0.25, 48, 24));
  const OctahedralAtlas atlas = atlas_of(scene, {.views = 8, .texels = 64, .depth_bits = 16});
  const CameraMatrices camera = seen_from({0.7, 1.1, 2.6});
  const double flat = depth_error(shown_by(atlas, camera, 0), scene, camera);
  const double one = depth_error(shown_by(atlas, camera, 1), scene, camera);
  const double three = depth_error(shown_by(atlas, camera, 3), scene, camera);
  MESSAGE(flat << ", " << one << ", " << three);
  CHECK(one < 0.85 * flat);
  CHECK(three < one);
}

TEST_CASE("what is nearer in the picture stays, and a hemisphere is seen from below from its rim") {
  const Scene scene = test::lit_mesh(make_sphere(0.8, 48, 24));
  const OctahedralAtlas atlas = atlas_of(scene, {.views = 4, .hemisphere = true, .texels = 48});
  const CameraMatrices camera = seen_from({0.0, -0.4, 3.0});
  CHECK(load_texel(shown_by(atlas, camera, 1), kSize / 2, kSize / 2).w < 3.0f);
  ThreadPool pool(2);
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  clear_image(picture, {0.0f, 1.0f, 0.0f, 0.5f}, Profile{});
  draw_octahedral(atlas, camera, 1, picture, pool);
  CHECK(load_texel(picture, kSize / 2, kSize / 2) == glm::vec4{0.0f, 1.0f, 0.0f, 0.5f});
}

TEST_CASE("an atlas gives the same bits with one thread and with three") {
  const Scene scene = test::lit_mesh(make_torus(0.7, 0.3, 24, 12));
  const OctahedralAtlas atlas = atlas_of(scene, {.views = 3, .texels = 40});
  const CameraMatrices camera = seen_from({1.0, 1.3, 2.0});
  CHECK(shown_by(atlas, camera, 2, 1).bytes == shown_by(atlas, camera, 2, 3).bytes);
}

TEST_CASE("a texel lies where its point is projected") {
  // The ray through a pixel meets the plane of a texel's own depth at that texel.
  const Scene scene = test::lit_mesh(make_sphere(0.8, 32, 16));
  const OctahedralAtlas atlas = atlas_of(scene, {.views = 4, .texels = 40});
  const CameraMatrices camera = seen_from({0.5, 0.9, 2.4});
  const ReliefTexture& picture = atlas.pictures[6];
  const OctahedralView view = octahedral_view(picture, atlas.radius_m, camera, kSize, kSize);
  for (const double code : {20.0, 127.0, 230.0}) {
    const glm::dvec3 point = relief_point(picture, 12.0, 25.0, code);
    const glm::dmat4 to_clip = multiply(camera.eye_to_clip, camera.world_to_eye);
    const glm::dvec4 clip =
        ((to_clip[0] * point.x + to_clip[1] * point.y) + to_clip[2] * point.z) + to_clip[3];
    const double x = (clip.x / clip.w + 1.0) * 0.5 * kSize - 0.5;
    const double y = (clip.y / clip.w + 1.0) * 0.5 * kSize - 0.5;
    const double q = view.q.at(x, y);
    const double depth_m = code * depth_step(picture) - atlas.radius_m * (1.0 + kDepthMargin);
    CHECK(std::fabs((view.u.at(x, y) + depth_m * view.slope_u.at(x, y)) / q - 12.0) < 1e-9);
    CHECK(std::fabs((view.v.at(x, y) + depth_m * view.slope_v.at(x, y)) / q - 25.0) < 1e-9);
    CHECK(std::fabs((view.height_m + depth_m) / q - clip.w) < 1e-9);
  }
}
