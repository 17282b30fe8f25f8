#include "scenes/random/random_scene.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr int kSize = 96;
constexpr std::uint64_t kSeeds = 40;

struct Seen {
  double in_focus = 0.0;      ///< share of the pixels with less than 1.5 pixels of 1024 rows
  double out_of_focus = 0.0;  ///< and with 4 or more
  double largest_px = 0.0;    ///< of 1024 rows
  float nearest_m = 1e9f;
};

Seen look_at(const Scene& scene, ThreadPool& pool) {
  const Image picture = draw_scene(scene, camera_matrices(scene.camera, 0.0, kSize, kSize), 0.0,
                                   kSize, kSize, Profile{}, pool);
  const PixelCoc coc =
      pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, 1024, scene.lens.coc_scale);
  Seen seen;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float depth_m = load_texel<Format::rgba16f>(picture, x, y).w;
      const double radius = std::fabs(static_cast<double>(coc_radius_px(coc, depth_m)));
      seen.in_focus += radius < 1.5 ? 1.0 : 0.0;
      seen.out_of_focus += radius >= 4.0 ? 1.0 : 0.0;
      seen.largest_px = std::max(seen.largest_px, radius);
      seen.nearest_m = std::min(seen.nearest_m, depth_m);
    }
  }
  seen.in_focus /= kSize * kSize;
  seen.out_of_focus /= kSize * kSize;
  return seen;
}

}  // namespace

TEST_CASE("random scenes: something is in focus, something is not, nothing touches the camera" *
          doctest::test_suite("long")) {
  ThreadPool pool(2);
  std::set<std::string> classes;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const Scene scene = make_random_scene(seed);
    const Seen seen = look_at(scene, pool);
    CAPTURE(scene.title);
    CHECK(seen.in_focus > 0.004);
    CHECK(seen.out_of_focus > 0.1);
    CHECK(seen.largest_px > 4.0);
    CHECK(seen.largest_px <= scene.lens.max_coc_px_at_1024);
    CHECK(static_cast<double>(seen.nearest_m) > 1.2 * scene.camera.near_m);
    CHECK(static_cast<double>(seen.nearest_m) > aperture_mm(scene.lens.lens) / 1000.0);
    CHECK(lens_error(scene.lens.lens) == nullptr);
    classes.insert(scene.title.substr(scene.title.find(": ") + 2));
  }
  // Each class was drawn, and its name is in the title.
  CHECK(classes ==
        std::set<std::string>(random_scene_classes().begin(), random_scene_classes().end()));
}

TEST_CASE("random scenes: a seed is one scene, by its name too") {
  const Scene once = make_random_scene(9);
  const Scene again = load_scene("random:9", {});
  REQUIRE(once.objects.size() == again.objects.size());
  CHECK(again.name == "random:9");
  for (std::size_t i = 0; i < once.objects.size(); ++i) {
    CHECK(once.objects[i].position == again.objects[i].position);
  }
  CHECK(make_random_scene(10).camera.fov_y_degrees != once.camera.fov_y_degrees);
  CHECK(load_scene("random:18446744073709551615", {}).name == "random:18446744073709551615");
}

TEST_CASE("random scenes: what is no seed is refused, with what would be right") {
  for (const char* name : {"random:", "random:-1", "random:07", "random:+1", "random:1x",
                           "random:1.5", "random: 1", "random:18446744073709551616"}) {
    CAPTURE(name);
    const std::string error = scene_error_of([&] { load_scene(name, {}); });
    CHECK(error.find(name) != std::string::npos);
    CHECK(error.find("a whole number from 0 to 18446744073709551615") != std::string::npos);
  }
}
