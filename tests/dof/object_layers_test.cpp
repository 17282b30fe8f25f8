#include "dof/object_layers/object_layers.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "dof/object_layers/hidden_parts.h"
#include "dof/object_layers/object_rungs.h"
#include "dof/object_layers/picture_objects.h"
#include "dof/scatter/scatter.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

DofSettings settings(float radius_at_infinity, float max_coc) {
  return {.coc = {radius_at_infinity, 2.0f}, .max_coc_px = max_coc};
}

// A picture with the radii, in pixels, that radius_at(x, y) gives; colours are colour_at(x, y).
// With settings(at_infinity, ...) a radius r, below at_infinity, is at 2 / (1 - r / at_infinity) m.
constexpr float kAtInfinity = 64.0f;
template <class RadiusAt, class ColourAt>
Image picture(int width, int height, const RadiusAt& radius_at, const ColourAt& colour_at) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float value = colour_at(x, y);
      const float depth_m = 2.0f / (1.0f - radius_at(x, y) / kAtInfinity);
      store_texel(image, x, y, {value, value, value, depth_m}, {});
    }
  }
  return image;
}

Image blurred(const Image& scene, const DofSettings& of, ThreadPool& pool,
              std::span<const std::uint16_t> objects = {}) {
  Image result = random_scene_image(scene.width, scene.height, 99);
  object_layers({scene, of, {}, objects}, result, pool);
  return result;
}

std::vector<std::uint16_t> random_numbers(int width, int height, std::uint64_t seed) {
  std::vector<std::uint16_t> numbers;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Random patch{seed * 1000 + static_cast<std::uint64_t>(y / 5 * 1000 + x / 11)};
      numbers.push_back(static_cast<std::uint16_t>(patch.unit() * 4.0f));
    }
  }
  return numbers;
}

// A plane of radii alone.
Planes radii_of(int width, int height, std::uint64_t seed, ThreadPool& pool) {
  Planes planes = make_planes(1, width, height, pool);
  Random random{seed};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      plane_row(planes, 0, y)[x] = std::floor(3.0f * random.unit()) * 0.7f;
    }
  }
  return planes;
}

// Every pixel takes the least number of its linked neighbours until nothing changes.
std::vector<std::uint32_t> flooded(const PictureObjects& objects) {
  std::vector<std::uint32_t> numbers(objects.links.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<std::uint32_t>(i);
  const auto width = static_cast<std::size_t>(objects.width);
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      for (const auto& [bit, step] :
           {std::pair{kLinkedRight, std::size_t{1}}, {kLinkedDown, width}}) {
        if ((objects.links[i] & bit) == 0 || numbers[i] == numbers[i + step]) continue;
        numbers[i] = numbers[i + step] = std::min(numbers[i], numbers[i + step]);
        changed = true;
      }
    }
  }
  return numbers;
}

double largest_step(const Image& image, int y, int from, int to) {
  double largest = 0.0;
  for (int x = from; x < to; ++x) {
    const double step =
        static_cast<double>(load_texel(image, x + 1, y).y - load_texel(image, x, y).y);
    largest = std::max(largest, std::fabs(step));
  }
  return largest;
}

}  // namespace

TEST_CASE("object-identification gives its oracle's bits, at any size and radius" *
          doctest::test_suite("long")) {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {2, 3}, {17, 15}, {70, 45}, {129, 31}}) {
    const Image scene = random_scene_image(size.width, size.height, 7);
    const std::vector<std::uint16_t> numbers = random_numbers(size.width, size.height, 3);
    for (const float max_coc : {0.0f, 0.7f, 6.9f, 8.0f, 11.0f, 40.0f}) {
      for (const bool numbered : {false, true}) {
        if (numbered && max_coc != 6.9f && max_coc != 40.0f) continue;
        const std::span<const std::uint16_t> objects =
            numbered ? std::span<const std::uint16_t>{numbers} : std::span<const std::uint16_t>{};
        const DofSettings of = settings(40.0f, max_coc);
        ThreadPool scalar(2, Isa::scalar);
        Image expected = make_image(scene.format, size.width, size.height);
        object_layers_oracle({scene, of, {}, objects}, expected, scalar);
        for (const Isa isa : available_isas()) {
          for (const int threads : {1, 3}) {
            ThreadPool pool(threads, isa);
            INFO(std::string{isa_name(isa)}, ", ", size.width, "x", size.height, ", ", max_coc,
                 numbered ? ", numbered" : "");
            CHECK(equal(blurred(scene, of, pool, objects), expected));
          }
        }
      }
    }
  }
}

TEST_CASE("a surface belongs to layers in shares that add up to one, in the order of depth") {
  const ObjectLadder ladder = make_object_ladder(100.0f);
  for (const double radius : {-100.0, -7.9, -1.2, -0.4, 0.0, 0.3, 1.0, 5.0, 8.5, 60.0, 100.0}) {
    const double square = radius * std::fabs(radius);
    double shares = 0.0, mean = 0.0;
    LayerBegin last{0.0f, 1.0f};
    const auto add = [&](const ObjectRung& layer, double sign) {
      CHECK(layer.begin.slope == last.slope);
      CHECK(layer.begin.offset == last.offset);
      last = layer.next;
      const double share =
          static_cast<double>(share_behind(layer.begin, static_cast<float>(square)) -
                              share_behind(layer.next, static_cast<float>(square)));
      shares += share;
      mean += share * sign * static_cast<double>(layer.rung->square);
    };
    for (std::size_t level = ladder.near.size(); level-- > 0;) {
      for (const ObjectRung& layer : ladder.near[level]) add(layer, -1.0);
    }
    for (const auto& level : ladder.far) {
      for (const ObjectRung& layer : level) add(layer, 1.0);
    }
    INFO("radius ", radius);
    CHECK(shares == doctest::Approx(1.0));
    CHECK(mean == doctest::Approx(square).epsilon(1e-3));
  }
}

TEST_CASE("an object without numbers is what linked neighbours connect, for any threads" *
          doctest::test_suite("threads")) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 70}, {90, 1}, {50, 100}, {33, 64}}) {
    ThreadPool memory(1);
    const Planes radii = radii_of(width, height, 5, memory);
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads);
      const PictureObjects objects = find_objects(radii, 0, {}, pool);
      CHECK(objects.numbers == flooded(objects));
      for (std::size_t i = 0; i < objects.numbers.size(); ++i) {
        const auto y = static_cast<int>(i) / width, x = static_cast<int>(i) % width;
        CHECK(objects.farthest_px[objects.numbers[i]] >= plane_row(radii, 0, y)[x]);
      }
    }
  }
}

TEST_CASE("a plane is one object at any slope, and a step in depth parts two") {
  ThreadPool pool(2);
  Planes planes = make_planes(1, 40, 20, pool);
  for (const float slope : {0.1f, 1.0f, 3.5f}) {
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) {
        plane_row(planes, 0, y)[x] = slope * static_cast<float>(x) - 0.5f * static_cast<float>(y);
      }
    }
    const PictureObjects one = find_objects(planes, 0, {}, pool);
    CHECK(std::count(one.numbers.begin(), one.numbers.end(), 0u) == 800);
    for (int y = 0; y < 20; ++y) {
      for (int x = 13; x < 40; ++x) plane_row(planes, 0, y)[x] -= 9.0f;
    }
    const PictureObjects two = find_objects(planes, 0, {}, pool);
    CHECK(std::count(two.numbers.begin(), two.numbers.end(), 0u) == 13 * 20);
    CHECK(std::count(two.numbers.begin(), two.numbers.end(), 13u) == 27 * 20);
  }
}

TEST_CASE("numbers part what has no step in depth, and tell a far part of an object to be of it") {
  ThreadPool pool(2);
  Planes planes = make_planes(1, 8, 1, pool);
  std::fill_n(plane_row(planes, 0, 0), 8, 3.0f);
  plane_row(planes, 0, 0)[7] = 9.0f;
  const std::vector<std::uint16_t> numbers{5, 5, 5, 7, 7, 5, 5, 5};
  const PictureObjects objects = find_objects(planes, 0, numbers, pool);
  CHECK((objects.links[1] & kLinkedRight) != 0);
  CHECK((objects.links[2] & kLinkedRight) == 0);
  CHECK((objects.links[4] & kLinkedRight) == 0);
  CHECK((objects.links[6] & kLinkedRight) == 0);  // of one number, but 6 pixels of radius apart
  CHECK(objects.farthest_px[5] == 9.0f);
  CHECK(objects.farthest_px[7] == 3.0f);
}

TEST_CASE("behind a pole a slanted wall goes on from either side") {
  // A wall of radii x / 8, colours x / 64; before it a pole at -6, 8 pixels wide.
  const auto is_pole = [](int x) { return x >= 28 && x < 36; };
  const Image scene = picture(
      64, 9, [&](int x, int) { return is_pole(x) ? -6.0f : static_cast<float>(x) / 8.0f; },
      [&](int x, int) { return is_pole(x) ? 9.0f : static_cast<float>(x) / 64.0f; });
  std::vector<std::uint16_t> numbers(9 * 64);
  for (int i = 0; i < 9 * 64; ++i) numbers[static_cast<std::size_t>(i)] = is_pole(i % 64) ? 2 : 1;
  ThreadPool pool(2);
  const Surfaces surfaces = find_surfaces({scene, settings(kAtInfinity, 32.0f), {}, numbers}, pool);
  for (int x = 0; x < 64; ++x) {
    const float* hidden = plane_row(surfaces.hidden, 0, 4) + x;
    const float share = hidden[hidden_plane::kShare * surfaces.hidden.plane];
    INFO("at ", x);
    CHECK(share == (is_pole(x) ? 1.0f : 0.0f));
    if (!is_pole(x)) continue;
    const float radius = hidden[hidden_plane::kRadius * surfaces.hidden.plane];
    CHECK(std::fabs(radius - static_cast<float>(x) / 8.0f) < 0.1f);
    CHECK(std::fabs(hidden[0] - static_cast<float>(x) / 64.0f) < 0.01f);
  }
}

TEST_CASE("a surface goes on as far behind a border as its circle is larger") {
  const Image scene = picture(
      80, 5, [](int x, int) { return x < 40 ? -3.0f : 5.0f; }, [](int, int) { return 1.0f; });
  ThreadPool pool(2);
  const Surfaces surfaces = find_surfaces({scene, settings(kAtInfinity, 32.0f), {}}, pool);
  const float* share = plane_row(surfaces.hidden, hidden_plane::kShare, 2);
  for (int x = 0; x < 80; ++x) {
    const float distance = static_cast<float>(40 - x);
    const float expected = x < 40 ? std::clamp(9.0f - distance, 0.0f, 1.0f) : 0.0f;
    CHECK(std::fabs(share[x] - expected) < 0.03f);  // half precision of the depth
  }
}

TEST_CASE("an object that lies in many layers is opaque before what is hidden behind it") {
  // A grey wall that leans from -20 to -2, with a white far wall beside it, which goes on behind.
  const auto radius_at = [](int x, int) {
    return x < 128 ? -20.0f + static_cast<float>(x) * 18.0f / 128.0f : 30.0f;
  };
  const auto colour_at = [](int x, int) { return x < 128 ? 0.25f : 1.0f; };
  const Image scene = picture(256, 64, radius_at, colour_at);
  ThreadPool pool(2);
  const Image result = blurred(scene, settings(kAtInfinity, 32.0f), pool);
  // The edge lies at a radius of 2: what is farther from it shows no far wall.
  for (int x = 0; x < 118; ++x) {
    INFO("at ", x);
    CHECK(load_texel(result, x, 32).y == doctest::Approx(0.25).epsilon(0.01));
  }
}

TEST_CASE("a blurred foreground's edge before something sharp is as soft inside as outside") {
  // scatter-sorted has nothing to show inside: there it stays dark.
  const Image scene = picture(
      128, 64, [](int x, int) { return x < 64 ? -10.0f : 0.0f; },
      [](int x, int) { return x < 64 ? 0.0f : 1.0f; });
  ThreadPool pool(2);
  const Image result = blurred(scene, settings(kAtInfinity, 32.0f), pool);
  Image sorted = make_image(scene.format, 128, 64);
  scatter_sorted({scene, settings(kAtInfinity, 32.0f), {}}, sorted, pool);
  double worst = 0.0, worst_sorted = 0.0;
  for (int x = 40; x < 88; ++x) {
    const double t = std::clamp((x + 0.5 - 64.0) / 10.0, -1.0, 1.0);
    const double truth = 0.5 + (t * std::sqrt(1.0 - t * t) + std::asin(t)) / 3.14159265358979;
    const auto error = [&](const Image& of) {
      return std::fabs(static_cast<double>(load_texel(of, x, 32).y) - truth);
    };
    worst = std::max(worst, error(result));
    worst_sorted = std::max(worst_sorted, error(sorted));
  }
  CHECK(worst < 0.04);
  CHECK(worst_sorted > 0.4);
}

TEST_CASE("a thin bar near the lens lets a smooth background through") {
  // 4 pixels wide at -12: it hides at most 4 / 12 / pi * 2 of it. The background is a slope.
  const auto is_bar = [](int x) { return x >= 62 && x < 66; };
  const Image scene = picture(
      128, 64, [&](int x, int) { return is_bar(x) ? -12.0f : 0.0f; },
      [&](int x, int) { return is_bar(x) ? 0.0f : 0.5f + static_cast<float>(x) / 256.0f; });
  ThreadPool pool(2);
  const Image result = blurred(scene, settings(kAtInfinity, 32.0f), pool);
  for (int x = 45; x < 83; ++x) {
    double hidden = 0.0;  // the bar's part of the disc about x
    for (int i = 0; i < 400; ++i) {
      const double at = 62.0 + (i + 0.5) / 100.0 - (x + 0.5);
      hidden += std::sqrt(std::max(144.0 - at * at, 0.0)) * 2.0 / 100.0 / (144.0 * 3.14159265);
    }
    const double background = 0.5 + x / 256.0;
    INFO("at ", x);
    CHECK(load_texel(result, x, 32).y ==
          doctest::Approx(background * (1.0 - hidden)).epsilon(0.03));
  }
}

TEST_CASE("with numbers, an object that a pole cuts in two is continued from both sides") {
  // A slanted wall; at the pole its halves are more than 3/4 pixel apart, so that without numbers
  // they are two objects, and each goes on by itself.
  const auto is_pole = [](int x) { return x >= 30 && x < 42; };
  const Image scene = picture(
      96, 33, [&](int x, int) { return is_pole(x) ? -8.0f : static_cast<float>(x) / 10.0f; },
      [&](int x, int) { return is_pole(x) ? 0.0f
                               : x < 30   ? 0.5f
                                          : 1.0f; });
  std::vector<std::uint16_t> numbers(33 * 96);
  for (int i = 0; i < 33 * 96; ++i) numbers[static_cast<std::size_t>(i)] = is_pole(i % 96) ? 1 : 2;
  ThreadPool pool(2);
  const DofSettings of = settings(kAtInfinity, 32.0f);
  const Surfaces alone = find_surfaces({scene, of, {}}, pool);
  const Surfaces numbered = find_surfaces({scene, of, {}, numbers}, pool);
  CHECK(plane_row(alone.hidden, 0, 16)[33] == 0.5f);
  CHECK(plane_row(alone.hidden, 0, 16)[38] == 1.0f);
  for (int x = 31; x < 41; ++x) {
    const float colour = plane_row(numbered.hidden, 0, 16)[x];
    CHECK(colour > plane_row(numbered.hidden, 0, 16)[x - 1]);
    CHECK(colour < 1.0f);
  }
  CHECK_FALSE(equal(blurred(scene, of, pool, numbers), blurred(scene, of, pool)));
}

TEST_CASE("a floor that runs through all layers has no seam") {
  // White from a radius of -30 to 30; any seam shows as another value.
  const Image scene = picture(
      64, 240, [](int, int y) { return 30.0f - static_cast<float>(y) / 4.0f; },
      [](int, int) { return 1.0f; });
  ThreadPool pool(2);
  const Image result = blurred(scene, settings(kAtInfinity, 32.0f), pool);
  for (int y = 0; y < 240; ++y)
    CHECK(load_texel(result, 32, y).y == doctest::Approx(1.0).epsilon(1e-3));
  CHECK(largest_step(result, 100, 0, 63) < 1e-3);
}
