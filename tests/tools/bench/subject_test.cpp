// bench without a scene: the sphere field and the picture.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "dof/lens.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/make/shapes.h"
#include "tools/bench/work.h"

using namespace softfocus;

namespace {

constexpr int kSide = 128;

int triangles_of(SphereCut cut) { return kFieldSpheres * 2 * cut.segments * (cut.rings - 1); }

Image drawn_field() {
  ThreadPool pool{2};
  const Scene scene = sphere_field(64000, 1.0);
  const CameraMatrices view = camera_matrices(scene.camera, 0.0, kSide, kSide);
  return draw_scene(scene, view, 0.0, kSide, kSide, Profile{}, pool);
}

// The share of the pixels whose depth in metres is as `holds` says.
template <class Holds>
double share(const Image& image, Holds holds) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += holds(load_texel(image, x, y).w) ? 1 : 0;
  }
  return static_cast<double>(count) / (image.width * image.height);
}

}  // namespace

TEST_CASE("sphere field: 64000, 256000 and 1024000 triangles are met exactly") {
  for (const int triangles : {64000, 256000, 1024000}) {
    CHECK(triangles_of(sphere_cut(triangles)) == triangles);
    CHECK(triangle_count(sphere_field(triangles, 1.0)) == static_cast<std::size_t>(triangles));
  }
}

TEST_CASE("sphere field: square cells are preferred, twice as many around as from pole to pole") {
  CHECK(sphere_cut(64000).segments == 16);
  CHECK(sphere_cut(64000).rings == 9);
  CHECK(sphere_cut(1024000).segments == 64);
  CHECK(sphere_cut(1024000).rings == 33);
}

TEST_CASE("sphere field: any number is met within two hundredths, once it is not tiny") {
  for (int triangles = 20000; triangles <= kMostFieldTriangles; triangles += triangles / 7) {
    CAPTURE(triangles);
    CHECK(std::abs(triangles_of(sphere_cut(triangles)) - triangles) <= triangles / 50);
  }
}

TEST_CASE("sphere field: the least and the most there can be are spheres") {
  CHECK(sphere_cut(kLeastFieldTriangles).segments >= 3);
  CHECK(sphere_cut(kLeastFieldTriangles).rings >= 2);
  CHECK(triangles_of(sphere_cut(kLeastFieldTriangles)) == kLeastFieldTriangles);
  CHECK(triangles_of(sphere_cut(kMostFieldTriangles)) == kMostFieldTriangles);
}

TEST_CASE(
    "sphere field: 250 textured spheres under one light, the texture repeated and mipmapped") {
  const Scene scene = sphere_field(64000, 1.0);
  CHECK(scene.objects.size() == 250);
  CHECK(scene.lights.size() == 1);
  REQUIRE(scene.materials.size() == 1);
  REQUIRE(scene.materials[0].texture);
  CHECK(scene.textures[*scene.materials[0].texture].levels.size() == 9);
  CHECK(scene.materials[0].sampler.wrap_u == Wrap::repeat);
  CHECK(scene.materials[0].sampler.filter == Filter::trilinear);
}

TEST_CASE("sphere field: spheres fill most of the picture, nearer and farther than the focus") {
  const Image image = drawn_field();
  const auto focus = static_cast<float>(sphere_field(64000, 1.0).lens.lens.focus_m);
  CHECK(share(image, [](float depth) { return depth < 49.0f; }) > 0.7);
  CHECK(share(image, [&](float depth) { return depth < 0.8f * focus; }) > 0.2);
  CHECK(share(image, [&](float depth) { return depth > 1.5f * focus && depth < 49.0f; }) > 0.1);
}

TEST_CASE("sphere field: its picture has the same bits on every machine") {
  CHECK(hash_image(drawn_field()) == 5892283502399822554u);
}

TEST_CASE("bench picture: circles from sharp to past the filter's largest, on both sides") {
  const Image image = bench_picture(kSide, kSide);
  constexpr float kMaxCoc = 16.0f;
  const PixelCoc coc{static_cast<float>(kBenchPictureHorizon) * kMaxCoc,
                     static_cast<float>(kBenchPictureFocusM)};
  const auto radius = [&](float depth) { return coc_radius_px(coc, depth); };
  CHECK(share(image, [&](float depth) { return radius(depth) > kMaxCoc; }) > 0.05);
  CHECK(share(image, [&](float depth) { return radius(depth) < -0.5f * kMaxCoc; }) > 0.05);
  CHECK(share(image, [&](float depth) { return std::fabs(radius(depth)) < 1.0f; }) > 0.02);
  CHECK(share(image, [&](float depth) { return std::fabs(radius(depth)) > 1.21f * kMaxCoc; }) ==
        0.0);
}

TEST_CASE("bench picture: depth jumps somewhere from one pixel to the next") {
  const Image image = bench_picture(kSide, kSide);
  float largest = 1.0f;
  for (int x = 1; x < kSide; ++x) {
    const float a = load_texel(image, x - 1, kSide / 2).w, b = load_texel(image, x, kSide / 2).w;
    largest = std::max({largest, a / b, b / a});
  }
  CHECK(largest > 1.5f);
}

TEST_CASE("bench picture: it has the same bits on every machine, at any size") {
  CHECK(hash_image(bench_picture(kSide, kSide)) == 17789011718496740110u);
  CHECK(bench_picture(1, 1).width == 1);
  CHECK(bench_picture(3, 200).height == 200);
}
