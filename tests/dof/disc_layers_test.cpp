#include "dof/disc_layers/disc_layers.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "dof/disc_layers/disc_levels.h"
#include "dof/disc_layers/disc_slopes.h"
#include "dof/measure/point_image.h"
#include "raster/images/texel.h"
#include "raster/numbers/random_bits.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

DofSettings settings(float radius_at_infinity, float max_coc) {
  return {.coc = {radius_at_infinity, 2.0f}, .max_coc_px = max_coc};
}

Image blurred(const Image& scene, const DofSettings& of, ThreadPool& pool) {
  Image result = random_scene_image(scene.width, scene.height, 99);
  disc_layers({scene, of, {}}, result, pool);
  return result;
}

// 4 (z - 2) / z = 2 at 4 m; black left of the middle, white right of it.
Image edge_image(float left_depth_m, float right_depth_m) {
  Image image = make_image(Format::rgba16f, 128, 96);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) {
      const float light = x < 64 ? 0.0f : 1.0f;
      store_texel(image, x, y, {light, light, light, x < 64 ? left_depth_m : right_depth_m}, {});
    }
  }
  return image;
}

// Lamps of random size, brightness and depth, some of them cut by the border, over a picture.
void add_lamps(Image& image, int count) {
  RandomSequence random{3};
  for (int i = 0; i < count; ++i) {
    const int size = 1 + static_cast<int>(next_between(random, 0.0, 3.0));
    const int left = static_cast<int>(next_between(random, -1.0, image.width));
    const int top = static_cast<int>(next_between(random, -1.0, image.height));
    const auto light = static_cast<float>(std::exp2(next_between(random, 3.0, 15.9)));
    const auto depth_m = static_cast<float>(next_between(random, 0.8, 12.0));
    for (int y = std::max(top, 0); y < std::min(top + size, image.height); ++y) {
      for (int x = std::max(left, 0); x < std::min(left + size, image.width); ++x) {
        store_texel(image, x, y, {light, 0.5f * light, -light, depth_m}, {});
      }
    }
  }
}

// The share of a disc about 0 that lies left of x.
double disc_left_of(double x, double radius) {
  const double t = std::fmin(std::fmax(x / radius, -1.0), 1.0);
  return 0.5 + (t * std::sqrt(1.0 - t * t) + std::asin(t)) / 3.14159265358979;
}

}  // namespace

TEST_CASE("disc-layers gives its oracle's bits, at any size and radius" *
          doctest::test_suite("long")) {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {2, 3}, {17, 15}, {70, 45}, {129, 31}, {140, 71}}) {
    const Image scene = random_scene_image(size.width, size.height, 7);
    for (const float max_coc : {0.0f, 0.7f, 6.9f, 7.25f, 8.0f, 11.0f, 40.0f}) {
      const DofSettings of = settings(40.0f, max_coc);
      ThreadPool scalar(2, Isa::scalar);
      Image expected = make_image(scene.format, size.width, size.height);
      disc_layers_oracle({scene, of, {}}, expected, scalar);
      for (const Isa isa : available_isas()) {
        ThreadPool pool(2, isa);
        INFO(std::string{isa_name(isa)}, ", ", size.width, "x", size.height, ", ", max_coc);
        CHECK(equal(blurred(scene, of, pool), expected));
      }
    }
  }
}

TEST_CASE("disc-layers gives its oracle's bits where there are highlights" *
          doctest::test_suite("long")) {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {17, 15}, {70, 45}, {140, 71}}) {
    Image scene = random_scene_image(size.width, size.height, 7);
    add_lamps(scene, 1 + size.width * size.height / 500);
    for (const float max_coc : {1.2f, 6.9f, 7.9f, 15.0f, 40.0f}) {
      const DofSettings of = settings(40.0f, max_coc);
      ThreadPool scalar(2, Isa::scalar);
      Image expected = make_image(scene.format, size.width, size.height);
      disc_layers_oracle({scene, of, {}}, expected, scalar);
      for (const Isa isa : available_isas()) {
        ThreadPool pool(3, isa);
        INFO(std::string{isa_name(isa)}, ", ", size.width, "x", size.height, ", ", max_coc);
        CHECK(equal(blurred(scene, of, pool), expected));
      }
    }
  }
}

// Light and radius both grow along x, or along y: radii of 16 (1 - 2 / z), from 4 by 1/16 a pixel.
Image ramp_image(bool along_y) {
  Image image = make_image(Format::rgba16f, 128, 128);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      const auto at = static_cast<float>(along_y ? y : x);
      const float light = at - 64.0f;
      store_texel(image, x, y, {light, light, light, 2.0f / (1.0f - (4.0f + at / 16.0f) / 16.0f)},
                  {});
    }
  }
  return image;
}

TEST_CASE("disc-layers sees a slope as a lens does: its side of larger radii less") {
  // q + v r_q = p with r_q = r_0 + g q: over a disc of v, whose mean square is 1/4 along an axis, q
  // is p + g r_p / 4 in the mean, to the second order of g.
  ThreadPool pool(2);
  for (const bool along_y : {false, true}) {
    const Image result = blurred(ramp_image(along_y), settings(16.0f, 40.0f), pool);
    double sum = 0.0;
    for (int at = 32; at < 96; ++at) {
      const float light = load_texel(result, along_y ? 64 : at, along_y ? at : 64).x;
      const double expected = at + (4.0 + at / 16.0) / 64.0;
      CAPTURE(along_y);
      CAPTURE(at);
      const double off = light + 64.0 - expected;
      CHECK(std::fabs(off) < 0.1);
      sum += off;
    }
    // Of discs about the pixels themselves it is 0.12.
    CHECK(std::fabs(sum / 64.0) < 0.05);
  }
}

TEST_CASE("centring discs leaves light as it is: on planes, ridges and valleys") {
  ThreadPool pool(2);
  constexpr int kSide = 128, kMiddle = 64;
  // The light of a bright column at `column`, over what it was.
  const auto kept_light = [&](const auto& radius_at, int column) {
    Image scene = make_image(Format::rgba16f, kSide, kSide);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const float light = x == column ? 0.9f : 0.2f;
        const auto depth_m = static_cast<float>(2.0 / (1.0 - radius_at(x) / 60.0));
        store_texel(scene, x, y, {light, light, light, depth_m}, {});
      }
    }
    const Image result = blurred(scene, settings(60.0f, 60.0f), pool);
    double got = 0.0;
    for (int x = 0; x < kSide; ++x) {
      got += static_cast<double>(load_texel(result, x, kMiddle).x) - 0.2;
    }
    return got / 0.7;
  };
  for (const double slope : {-0.1, -0.05, 0.05, 0.1}) {
    CAPTURE(slope);
    const auto bent = [&](int x) { return 20.0 + slope * std::abs(x - kMiddle); };
    CHECK(std::fabs(kept_light(bent, kMiddle) - 1.0) < 0.2);
    for (const int column : {60, 61, 62, 63, 64, 65}) {  // depths are rounded to halves
      CAPTURE(column);
      const auto flat = [&](int x) { return 20.0 + slope * (x - kMiddle); };
      CHECK(std::fabs(kept_light(flat, column) - 1.0) < 0.1);
    }
  }
}

TEST_CASE("discs are centred on slopes alone, and every vector unit gives the scalar form's bits") {
  const auto centred = [](const Image& scene, const DofSettings& of, Isa isa) {
    ThreadPool pool(2, isa);
    return copy_of(centre_discs({scene, of, {}}, pool).picture, pool);
  };
  const Image outline = edge_image(4.0f, 2.5f);
  CHECK(equal(centred(outline, settings(8.0f, 40.0f), Isa::scalar), outline));
  const Image ramp = ramp_image(false);
  CHECK(equal(centred(ramp, settings(0.5f, 40.0f), Isa::scalar), ramp));
  CHECK(!equal(centred(ramp, settings(16.0f, 40.0f), Isa::scalar), ramp));
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {15, 2}, {16, 17}, {70, 40}}) {
    Image scene = make_image(Format::rgba16f, size.width, size.height);
    RandomSequence random{static_cast<std::uint64_t>(size.width)};
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        // A rough slope, some of whose pixels are infinite or no numbers.
        const auto light = static_cast<float>(next_between(random, -1.0, 3.0));
        const float odd = x % 2 == 0 ? light / 0.0f : std::nanf("");
        const auto rough = static_cast<float>(next_between(random, -0.02, 0.02));
        const float depth_m =
            y == 20 ? odd
                    : 3.0f + 0.05f * static_cast<float>(x) - 0.04f * static_cast<float>(y) + rough;
        store_texel(scene, x, y,
                    {x % 9 == 3 ? odd : light, x % 11 == 5 ? 65504.0f : light, -light, depth_m},
                    {});
      }
    }
    const DofSettings of = settings(40.0f, 60.0f);
    const Image expected = centred(scene, of, Isa::scalar);
    for (const Isa isa : available_isas()) {
      INFO(std::string{isa_name(isa)}, ", ", size.width);
      CHECK(equal(centred(scene, of, isa), expected));
    }
  }
}

TEST_CASE("a highlight's image is a disc of its own radius, between rungs and levels too") {
  ThreadPool pool(2);
  double before = 0.0;
  for (int step = 0; step <= 80; ++step) {
    const double radius = 2.0 * std::exp2(step / 16.0);
    const int size = 2 * static_cast<int>(radius) + 9;
    for (const float depth_m : {4.0f, 4.0f / 3.0f}) {
      Image scene = make_image(Format::rgba16f, size, size);
      clear_image(scene, {0.0f, 0.0f, 0.0f, depth_m}, {});
      store_texel(scene, size / 2, size / 2, {30000.0f, 30000.0f, 30000.0f, depth_m}, {});
      const float at_infinity = 2.0f * static_cast<float>(radius);
      const double deviation =
          disc_deviation(blurred(scene, settings(at_infinity, kLargestMaxCoc), pool), radius);
      INFO("radius ", radius, " at ", depth_m, " m");
      CHECK(deviation < 0.03);
      if (step > 0) CHECK(std::fabs(deviation - before) < 0.02);
      before = deviation;
    }
  }
}

TEST_CASE("something sharp cuts a highlight's disc, and leaves the rest as bright as it is") {
  ThreadPool pool(2);
  for (const float max_coc : {6.0f, 14.5f, 30.0f}) {
    // A lamp at infinity beside a black half in focus.
    Image scene = make_image(Format::rgba16f, 128, 96);
    for (int y = 0; y < 96; ++y) {
      for (int x = 0; x < 128; ++x) {
        const float light = x == 64 && y == 48 ? 20000.0f : 0.0f;
        store_texel(scene, x, y, {light, light, light, x < 64 ? 2.0f : 1000.0f}, {});
      }
    }
    const Image result = blurred(scene, settings(2.0f * max_coc, max_coc), pool);
    const double area = 3.14159265358979 * static_cast<double>(max_coc) * max_coc;
    const int edge = 64 + static_cast<int>(max_coc);
    INFO(max_coc);
    CHECK(load_texel(result, 63, 48).y == 0.0f);
    for (const int x : {64, 68, edge - 2}) {
      CHECK(load_texel(result, x, 48).y == doctest::Approx(20000.0 / area).epsilon(0.01));
    }
    CHECK(load_texel(result, edge + 2, 48).y < 1.0f);
  }
}

TEST_CASE("disc-layers gives its oracle's bits if hardly anything is blurred" *
          doctest::test_suite("long")) {
  // All in focus but one pixel, whose radius, 40 (z - 2) / z, is 7 to 37 pixels.
  const DofSettings of = settings(40.0f, 40.0f);
  const int width = 330, height = 70;
  ThreadPool scalar(2, Isa::scalar), pool(2);
  for (const float depth_m : {1.05f, 1.7f, 30.0f}) {
    for (const int x : {61, 126, 131, 190}) {
      Image scene = random_scene_image(width, height, 7);
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
          glm::vec4 texel = load_texel<Format::rgba16f>(scene, u, v);
          texel.w = u == x && v == x / 4 ? depth_m : 2.0f;
          store_texel(scene, u, v, texel, {});
        }
      }
      Image expected = make_image(scene.format, width, height);
      disc_layers_oracle({scene, of, {}}, expected, scalar);
      INFO(x, ", ", depth_m);
      CHECK(equal(blurred(scene, of, pool), expected));
    }
  }
}

TEST_CASE("a rung's disc has the second moment of its circle") {
  // In level 0, where the size of pixels adds nothing.
  const std::vector<LevelRungs> ladder = make_ladder(7.0f);
  REQUIRE(ladder.size() == 2);
  REQUIRE(ladder[0].rungs.size() == static_cast<std::size_t>(kFineRungs));
  for (std::size_t i = 1; i < ladder[0].rungs.size(); ++i) {
    const Rung& rung = ladder[0].rungs[i];
    double area = 0.0, across = 0.0, down = 0.0;
    for (int dx = 1 - static_cast<int>(rung.spans.size()); dx < static_cast<int>(rung.spans.size());
         ++dx) {
      const LadderSpan& span = rung.spans[static_cast<std::size_t>(std::abs(dx))];
      for (int dy = -span.whole - 1; dy <= span.whole + 1; ++dy) {
        const double weight =
            static_cast<double>(std::abs(dy) > span.whole ? span.end : span.centre);
        area += weight;
        across += weight * dx * dx;
        down += weight * dy * dy;
      }
    }
    const double square = static_cast<double>(rung.square);
    INFO("radius ", std::sqrt(square));
    CHECK(static_cast<double>(rung.area) == doctest::Approx(area).epsilon(1e-6));
    CHECK((across + down) / area == doctest::Approx(square / 2.0).epsilon(1e-3));
    CHECK(across / down == doctest::Approx(1.0).epsilon(0.1));
  }
}

TEST_CASE("a pixel between two rungs counts to both, and the mean of the squares is its own") {
  const std::vector<LevelRungs> ladder = make_ladder(100.0f);
  for (const double radius : {0.3, 1.1, 1.3, 5.0, 7.5}) {
    const float square = static_cast<float>(radius * radius);
    double shares = 0.0, mean = 0.0;
    for (std::size_t i = 0; i <= ladder[0].rungs.size(); ++i) {
      const auto share_from_rung = [&](std::size_t rung) {
        const RungStep step = rung < ladder[0].rungs.size()    ? ladder[0].rungs[rung].step
                              : rung == ladder[0].rungs.size() ? ladder[0].beyond
                                                               : RungStep{1e9f, 1.0f};
        return share_from(step, square);
      };
      const float of =
          i < ladder[0].rungs.size() ? ladder[0].rungs[i].square : ladder[1].rungs[0].square;
      const double share = static_cast<double>(share_from_rung(i) - share_from_rung(i + 1));
      shares += share;
      mean += share * static_cast<double>(of);
    }
    CHECK(shares == doctest::Approx(1.0));
    CHECK(mean == doctest::Approx(radius * radius).epsilon(1e-5));
  }
}

TEST_CASE("a foreground's edge before a blurred background is as soft as its own circle") {
  ThreadPool pool(2);
  // Black at 1.5 m before white at 8 m: radii -6.67 and 15 for 20 at infinity.
  const Image result = blurred(edge_image(1.5f, 8.0f), settings(20.0f, 16.0f), pool);
  double largest = 0.0;
  for (int x = 40; x < 88; ++x) {
    const double expected = 1.0 - disc_left_of(63.5 - x, 20.0 / 3.0);
    const double got = static_cast<double>(load_texel(result, x, 48).y);
    largest = std::fmax(largest, std::fabs(got - expected));
  }
  CHECK(largest < 0.05);
}

TEST_CASE("a surface that runs through all layers is nowhere seen through") {
  ThreadPool pool(2);
  // White, from 1 m to 8 m, with a black wall far behind in the upper half.
  Image scene = make_image(Format::rgba16f, 256, 96);
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float light = y < 40 ? 0.0f : 1.0f;
      const float depth_m = y < 40 ? 60.0f : 1.0f + 7.0f * static_cast<float>(x) / 256.0f;
      store_texel(scene, x, y, {light, light, light, depth_m}, {});
    }
  }
  const Image result = blurred(scene, settings(20.0f, 32.0f), pool);
  float least = 1.0f;
  for (int x = 0; x < 256; ++x) least = std::fmin(least, load_texel(result, x, 90).y);
  CHECK(least > 0.998f);
}

TEST_CASE("disc-layers keeps a point's light and its circle's second moment from 4 to 64 pixels") {
  ThreadPool pool(2);
  for (int step = 0; step <= 32; ++step) {
    const double radius = 4.0 * std::exp2(step / 8.0);
    const int size = 4 * static_cast<int>(radius) + 65;
    for (const float depth_m : {4.0f, 4.0f / 3.0f}) {  // behind the focus and before it
      // Not in the middle of a level's pixel, nor in the same place of it each time.
      const int at_x = size / 2 + step % 5, at_y = size / 2 + step % 7;
      Image scene = make_image(Format::rgba16f, size, size);
      clear_image(scene, {0.0f, 0.0f, 0.0f, depth_m}, {});
      store_texel(scene, at_x, at_y, {30000.0f, 30000.0f, 30000.0f, depth_m}, {});
      const Image result =
          blurred(scene, settings(2.0f * static_cast<float>(radius), kLargestMaxCoc), pool);
      double light = 0.0, square = 0.0, off_x = 0.0, off_y = 0.0;
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          const double value = static_cast<double>(load_texel(result, x, y).y);
          const double dx = x - at_x, dy = y - at_y;
          light += value;
          square += value * (dx * dx + dy * dy);
          off_x += value * dx;
          off_y += value * dy;
        }
      }
      INFO("radius ", radius, " at ", depth_m, " m");
      CHECK(light / 30000.0 == doctest::Approx(1.0).epsilon(0.002));
      // sqrt(2 E[d^2]) about the point itself, that of a disc with its second moment.
      CHECK(std::sqrt(2.0 * square / light) == doctest::Approx(radius).epsilon(0.02));
      CHECK(std::fabs(off_x / light) <= 0.01 * radius);
      CHECK(std::fabs(off_y / light) <= 0.01 * radius);
    }
  }
}
