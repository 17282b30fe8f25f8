#include <doctest/doctest.h>

#include <cmath>

#include "dof/scatter/layers.h"
#include "dof/scatter/scatter.h"
#include "dof/scatter/scatter_discs.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

using Filter = void (*)(const DofInput&, const ImageView&, ThreadPool&);

Image filtered(Filter filter, const Image& scene, const DofSettings& settings, ThreadPool& pool) {
  Image result = make_image(Format::rgba16f, scene.width, scene.height);
  filter({scene, settings, {}}, result, pool);
  return result;
}

}  // namespace

TEST_CASE("scatter gives its oracle's bits") {
  ThreadPool pool(3);
  for (const SlabRule rule : {SlabRule::one, SlabRule::doubling}) {
    for (const int size : {1, 2, 37, 64}) {
      const Image scene = random_scene_image(size, 66 - size, 1);
      for (const float max_coc : {0.0f, 0.7f, 2.0f, 9.4f, 100.0f}) {
        const DofSettings settings{.coc = {30.0f, 2.0f}, .max_coc_px = max_coc};
        Image result = make_image(Format::rgba16f, scene.width, scene.height), expected = result;
        scatter_in_slabs({scene, settings, {}}, result, rule, pool);
        scatter_in_slabs_oracle({scene, settings, {}}, expected, rule, pool);
        CHECK(equal(result, expected));
      }
    }
  }
}

TEST_CASE("a scattered disc has a disc's area and second moment") {
  const ScatterDiscs discs = make_discs(40.0f);
  for (int disc = 3; disc < discs.count; ++disc) {
    const double radius = 0.25 * disc;
    double area = 0.0, along = 0.0, across = 0.0;
    for (int dy = -discs.reach; dy <= discs.reach; ++dy) {
      const DiscSpan span =
          discs.spans[static_cast<std::size_t>(std::abs(dy) * discs.count + disc)];
      for (int dx = -span.whole - 1; dx <= span.whole + 1; ++dx) {
        const bool end = std::abs(dx) == span.whole + 1;
        const double covered = !end               ? 1.0
                               : span.whole == -1 ? 0.25 * span.eighths - 1.0
                                                  : 0.125 * span.eighths;
        area += covered;
        along += covered * dx * dx;
        across += covered * dy * dy;
      }
    }
    INFO("radius ", radius);
    CHECK(discs.weights[static_cast<std::size_t>(disc)] == static_cast<float>(1.0 / area));
    CHECK(std::fabs(area / (3.14159265 * radius * radius) - 1.0) < 0.1 / radius);
    CHECK(std::fabs(along / area - radius * radius / 4.0) < 0.2 * radius);
    CHECK(std::fabs(along - across) / area < 0.15 * radius);
  }
}

TEST_CASE("sorted scatter and layers keep a background's light off a sharp object before it") {
  ThreadPool pool(2);
  // The left half in focus and black, the right half far and bright.
  Image scene = random_scene_image(64, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float light = x < 32 ? 0.0f : 10.0f;
      store_texel(scene, x, y, {light, light, light, x < 32 ? 2.0f : 50.0f}, {});
    }
  }
  const DofSettings settings{.coc = {12.0f, 2.0f}, .max_coc_px = 16.0f};
  const Image sorted = filtered(scatter_sorted, scene, settings, pool);
  for (int x = 0; x < 32; ++x) CHECK(load_texel(sorted, x, 30).x == 0.0f);
  const Image layered = filtered(layers, scene, settings, pool);
  for (int x = 0; x < 32; ++x) CHECK(load_texel(layered, x, 30).x == 0.0f);
  // Unsorted scatter does not.
  const Image unsorted = filtered(scatter_unsorted, scene, settings, pool);
  CHECK(load_texel(unsorted, 31, 30).x > 1.0f);
}

TEST_CASE(
    "sorted scatter and layers put a blurred foreground over a sharp background, by half at its "
    "edge") {
  ThreadPool pool(2);
  Image scene = random_scene_image(96, 64, 4);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const bool near = x < 48;
      const float light = near ? 0.0f : 1.0f;
      store_texel(scene, x, y, {light, light, light, near ? 1.0f : 2.0f}, {});
    }
  }
  // Radius 10 before the focus.
  const DofSettings settings{.coc = {10.0f, 2.0f}, .max_coc_px = 16.0f};
  for (const Filter filter : {scatter_sorted, layers}) {
    const Image result = filtered(filter, scene, settings, pool);
    CHECK(load_texel(result, 48, 32).x == doctest::Approx(0.5).epsilon(0.1));
    CHECK(load_texel(result, 53, 32).x == doctest::Approx(0.8).epsilon(0.1));
    CHECK(load_texel(result, 59, 32).x == 1.0f);
  }
}
