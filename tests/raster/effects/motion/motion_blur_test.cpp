#include "raster/effects/motion/motion_blur.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

constexpr std::array kFilters{MotionFilter::one_way, MotionFilter::two_ways};

Image even_velocity(int width, int height, glm::vec2 px) {
  Image velocity = make_image(Format::rg16f, width, height);
  clear_image(velocity, {px, 0.0f, 1.0f}, {});
  return velocity;
}

Image blurred(const MotionBlurSettings& settings, const Image& picture, const Image& velocity,
              ThreadPool& pool, const Profile& profile = {}) {
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  motion_blur(settings, picture, velocity, result, profile, pool);
  return result;
}

Image blurred_simply(float shutter, int samples, const Image& picture, const Image& velocity,
                     ThreadPool& pool, const Profile& profile = {}) {
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  motion_blur_along_own(shutter, samples, picture, velocity, result, profile, pool);
  return result;
}

/// White on the right, at one depth.
Image edge_picture(int width, int height) {
  Image picture = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float light = x >= width / 2 ? 1.0f : 0.0f;
      store_texel(picture, x, y, {light, light, light, 4.0f}, {});
    }
  }
  return picture;
}

struct MovingSquare {
  Image picture, velocity;
};

/// A square of light in the middle, alone to move. Its depth and the background's.
MovingSquare moving_square(glm::vec2 px, float depth_m, float background_m) {
  MovingSquare scene{make_image(Format::rgba16f, 96, 64), make_image(Format::rg16f, 96, 64)};
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const bool inside = std::abs(x - 48) < 10 && std::abs(y - 32) < 10;
      const float light = inside ? 1.0f : 0.0f;
      store_texel(scene.picture, x, y, {light, light, light, inside ? depth_m : background_m}, {});
      if (inside) store_texel(scene.velocity, x, y, {px, 0.0f, 1.0f}, {});
    }
  }
  return scene;
}

float red(const Image& picture, int x, int y) { return load_texel(picture, x, y).x; }

/// Halves of any bits among pictures, and motions of any length.
struct AnyPicture {
  Image picture, velocity;
};
AnyPicture any_picture(int width, int height, bool any_bits) {
  AnyPicture any{test::random_halves(width, height, 21, 0.0, 5.0),
                 make_image(Format::rg16f, width, height)};
  RandomSequence random{22};
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(any.velocity, y)) {
      const double most = (y / 16 % 3) * 12.0;
      value = float_to_half(static_cast<float>(next_between(random, -most, most)),
                            HalfRounding::nearest_even);
      if (any_bits && next_bits(random) % 31 == 0) {
        value = static_cast<std::uint16_t>(next_bits(random) >> 48);
      }
    }
    for (std::uint16_t& value : row<std::uint16_t>(any.picture, y)) {
      if (any_bits && next_bits(random) % 31 == 0) {
        value = static_cast<std::uint16_t>(next_bits(random) >> 48);
      }
    }
  }
  return any;
}

// --- the equations, in binary64 ---

double ramp(double x) { return std::clamp(x, 0.0, 1.0); }
double cylinder(double q) {
  const double s = ramp((q - 0.95) / 0.1);
  return 1.0 - s * s * (3.0 - 2.0 * s);
}

glm::dvec2 to_either_side(const MotionBlurSettings& settings, const Image& velocity, int x, int y) {
  const glm::vec4 px = load_texel<Format::rg16f>(velocity, x, y);
  glm::dvec2 v = glm::dvec2{px.x, px.y} * (0.5 * static_cast<double>(settings.shutter));
  const double length = std::hypot(v.x, v.y);
  if (length > settings.radius_px) v *= settings.radius_px / length;
  return v;
}

struct Blurring {
  const MotionBlurSettings& settings;
  const Image& picture;
  const Image& velocity;
  int x, y;
};

/// A sample `px` from the pixel, and what the pixel and it have to do with each other.
struct Sample {
  glm::dvec3 colour;
  glm::dvec2 w;
  double of_there, of_own;  ///< the distance in lengths of either's motion, none below 1/2
  double gap;               ///< how much farther, in parts of what lies wholly before another
};

Sample sample_at(const Blurring& of, glm::dvec2 px) {
  const auto place = [](int at, double off, int size) {
    return std::clamp(static_cast<int>(std::floor(at + off + 0.5)), 0, size - 1);
  };
  const int x = place(of.x, px.x, of.picture.width), y = place(of.y, px.y, of.picture.height);
  const glm::vec4 own = load_texel(of.picture, of.x, of.y), there = load_texel(of.picture, x, y);
  const glm::dvec2 v = to_either_side(of.settings, of.velocity, of.x, of.y);
  const glm::dvec2 w = to_either_side(of.settings, of.velocity, x, y);
  const double distance = std::hypot(px.x, px.y);
  const double extent = static_cast<double>(of.settings.depth) * static_cast<double>(own.w);
  const double gap = static_cast<double>(there.w) - static_cast<double>(own.w);
  return {{there.x, there.y, there.z},
          w,
          distance / std::max(std::hypot(w.x, w.y), 0.5),
          distance / std::max(std::hypot(v.x, v.y), 0.5),
          gap / extent};
}

double jitter_of(const Blurring& of) {
  return static_cast<double>(jitter_bits(of.x, of.y)) / 0x1p24;
}

/// McGuire et al. 2012.
glm::dvec3 one_way(const Blurring& of, glm::dvec2 n) {
  const glm::dvec2 v = to_either_side(of.settings, of.velocity, of.x, of.y);
  double total = 1.0 / std::max(std::hypot(v.x, v.y), 0.5);
  glm::dvec3 sum = glm::dvec3{glm::vec3{load_texel(of.picture, of.x, of.y)}} * total;
  for (int i = 0; i < of.settings.samples; ++i) {
    const double t = 2.0 * (i + jitter_of(of)) / of.settings.samples - 1.0;
    const Sample sample = sample_at(of, n * t);
    const double weight = ramp(1.0 - sample.gap) * ramp(1.0 - sample.of_there) +
                          ramp(1.0 + sample.gap) * ramp(1.0 - sample.of_own) +
                          2.0 * cylinder(sample.of_there) * cylinder(sample.of_own);
    total += weight;
    sum += sample.colour * weight;
  }
  return sum / total;
}

/// The part of the samples along `way` that the pixel shows, and their mean where it does not show
/// `instead`.
struct SeenAlong {
  double part;
  glm::dvec3 colour;
};

SeenAlong seen_along(const Blurring& of, glm::dvec2 way, double own_part, double own_reach,
                     int samples, double jitter, const glm::dvec3& instead) {
  const double length = std::hypot(way.x, way.y);
  const auto reached = [](double q) { return ramp((1.05 - q) * 10.0); };
  SeenAlong seen{0.0, glm::dvec3{0.0}};
  for (int i = 0; i < samples; ++i) {
    const Sample sample = sample_at(of, way * (2.0 * (i + jitter) / samples - 1.0));
    const double along = std::abs(sample.w.x * way.x + sample.w.y * way.y) /
                         (length * std::max(std::hypot(sample.w.x, sample.w.y), 0.5));
    const double of_there = ramp(2.0 - 2.0 * sample.gap) * reached(sample.of_there) * along;
    const double of_own =
        ramp(2.0 + 2.0 * sample.gap) * own_part * std::max(reached(sample.of_own), own_reach);
    const double weight = ramp(of_there + of_own);
    seen.part += weight / samples;
    seen.colour += (sample.colour * weight + instead * (1.0 - weight)) / (1.0 * samples);
  }
  return seen;
}

/// After Guertin et al. 2014.
glm::dvec3 two_ways(const Blurring& of, glm::dvec2 n) {
  const glm::dvec3 own{glm::vec3{load_texel(of.picture, of.x, of.y)}};
  glm::dvec2 v = to_either_side(of.settings, of.velocity, of.x, of.y);
  if (v.x * n.x + v.y * n.y < 0.0) v = -v;
  const double moving = ramp((std::hypot(v.x, v.y) - 0.5) / 1.5);
  const glm::dvec2 across = n * (1.0 - moving) + v * moving;
  const double length = std::hypot(n.x, n.y), own_length = std::hypot(across.x, across.y);
  const double facing = std::abs(across.x * n.x + across.y * n.y) / (length * own_length);
  const double jitter = jitter_of(of);
  const int samples = of.settings.samples;
  const SeenAlong second =
      seen_along(of, across, 1.0, moving, samples / 2, std::fmod(jitter + 0.5, 1.0), own);
  const SeenAlong first = seen_along(of, n, ramp(1.1 * facing), 0.0, samples - samples / 2, jitter,
                                     own * (1.0 - moving) + second.colour * moving);
  const double half = 0.5 * facing * std::min(1.0, own_length / length);
  return first.colour * (1.0 - half) + second.colour * half;
}

glm::dvec3 expected_colour(const MotionBlurSettings& settings, const Image& picture,
                           const Image& velocity, const MotionTiles& tiles, int x, int y) {
  const bool in_two_ways = settings.filter == MotionFilter::two_ways;
  const int size = settings.radius_px;
  int at_x = x, at_y = y;
  if (in_two_ways) {
    const auto off = [&](int a, int b) {
      return (static_cast<int>(jitter_bits(a, b) >> 16) - 128) * size >> 9;
    };
    at_x = std::clamp(x + off(y, x), 0, picture.width - 1);
    at_y = std::clamp(y + off(y + 1, x), 0, picture.height - 1);
  }
  const glm::dvec2 n{tiles.v[static_cast<std::size_t>(at_y / size * tiles.columns + at_x / size)]};
  if (std::hypot(n.x, n.y) <= 0.5) return glm::dvec3{glm::vec3{load_texel(picture, x, y)}};
  const Blurring of{settings, picture, velocity, x, y};
  return in_two_ways ? two_ways(of, n) : one_way(of, n);
}

}  // namespace

TEST_CASE("motion blur is its equations, to a step of the halves") {
  ThreadPool pool{2};
  const AnyPicture any = any_picture(90, 70, false);
  for (const MotionFilter filter : kFilters) {
    const MotionBlurSettings settings{
        .shutter = 1.5f, .samples = 9, .radius_px = 12, .depth = 0.5f, .filter = filter};
    const Image result = blurred(settings, any.picture, any.velocity, pool);
    const MotionBlurPass pass = pass_of(settings);
    Image spread = make_image(Format::rgba16f, 90, 70);
    motion_to_either_side(pass, any.velocity, spread, {}, pool);
    const MotionTiles tiles = longest_of_neighbours(longest_of_tiles(pass, spread, pool), filter);
    int wrong = 0, moved = 0;
    for (int y = 0; y < 70; ++y) {
      for (int x = 0; x < 90; ++x) {
        const glm::dvec3 expected =
            expected_colour(settings, any.picture, any.velocity, tiles, x, y);
        const glm::dvec3 found{load_texel(result, x, y)};
        // The steps between hold halves; where a sample falls between pixels, either may be read.
        const glm::dvec3 off = glm::abs(found - expected);
        wrong += std::max({off.x, off.y, off.z}) > 0.02 ? 1 : 0;
        moved += red(result, x, y) != red(any.picture, x, y) ? 1 : 0;
      }
    }
    CHECK(wrong <= 90 * 70 / 200);
    CHECK(moved > 90 * 70 / 2);
  }
}

TEST_CASE("motion blur leaves a picture alone in which nothing moves, to the bit") {
  ThreadPool pool{2};
  const AnyPicture any = any_picture(70, 50, true);
  for (const glm::vec2 px : {glm::vec2{0.0f}, glm::vec2{0.7f, -0.5f}}) {
    const Image velocity = even_velocity(70, 50, px);
    for (const MotionFilter filter : kFilters) {
      CHECK(equal(blurred({.shutter = 1.0f, .filter = filter}, any.picture, velocity, pool),
                  any.picture));
    }
    CHECK(equal(blurred_simply(1.0f, 8, any.picture, velocity, pool), any.picture));
  }
}

TEST_CASE("a shutter that is not open at all blurs nothing") {
  ThreadPool pool{1};
  const AnyPicture any = any_picture(70, 50, false);
  CHECK(equal(blurred({.shutter = 0.0f}, any.picture, any.velocity, pool), any.picture));
  CHECK(equal(blurred_simply(0.0f, 8, any.picture, any.velocity, pool), any.picture));
}

TEST_CASE("an edge that moves with all else becomes a ramp as wide as its way") {
  ThreadPool pool{1};
  const Image edge = edge_picture(96, 32), velocity = even_velocity(96, 32, {40.0f, 0.0f});
  // Half a frame: 20 pixels, from 38 to 58.
  const Image simple = blurred_simply(0.5f, 32, edge, velocity, pool);
  for (int x = 30; x < 66; ++x) {
    const double expected = std::clamp((x - 38) / 20.0, 0.0, 1.0);
    CHECK(static_cast<double>(red(simple, x, 16)) == doctest::Approx(expected).epsilon(0.06));
  }
  for (const MotionFilter filter : kFilters) {
    const Image result =
        blurred({.shutter = 0.5f, .samples = 32, .filter = filter}, edge, velocity, pool);
    for (int x = 0; x < 96; ++x) {
      if (x < 36) CHECK(red(result, x, 16) == 0.0f);
      if (x > 59) CHECK(red(result, x, 16) == doctest::Approx(1.0).epsilon(0.001));
      if (x > 36) CHECK(red(result, x, 16) >= red(result, x - 1, 16) - 0.06f);
    }
    CHECK(red(result, 48, 16) == doctest::Approx(0.5).epsilon(0.2));
  }
}

TEST_CASE("what moves before a still background reaches over its outline, but not simply") {
  ThreadPool pool{1};
  const MovingSquare scene = moving_square({24.0f, 0.0f}, 2.0f, 8.0f);
  const Image simple = blurred_simply(1.0f, 16, scene.picture, scene.velocity, pool);
  CHECK(red(simple, 48 + 10 + 3, 32) == 0.0f);
  for (const MotionFilter filter : kFilters) {
    const Image result =
        blurred({.shutter = 1.0f, .filter = filter}, scene.picture, scene.velocity, pool);
    for (const int side : {-1, 1}) {
      CHECK(red(result, 48 + side * 13, 32) > 0.15f);
      CHECK(red(result, 48 + side * 13, 32) < 0.85f);
      CHECK(red(result, 48 + side * 8, 32) < 0.95f);
      CHECK(red(result, 48 + side * 24, 32) == 0.0f);  // 10 + 12 and a pixel
    }
    CHECK(red(result, 48, 32 - 13) == 0.0f);  // nothing moves up or down
  }
}

TEST_CASE("of a still background shows what the shutter leaves of it") {
  ThreadPool pool{1};
  // The square goes 16 pixels to either side: at a distance d from its outline it covers the pixel
  // for (16 - d) / 32 of the time.
  const MovingSquare scene = moving_square({32.0f, 0.0f}, 2.0f, 8.0f);
  const Image result =
      blurred({.shutter = 1.0f, .samples = 64}, scene.picture, scene.velocity, pool);
  for (const int side : {-1, 1}) {
    for (int d = 1; d < 20; ++d) {
      const double expected = std::max(16.5 - d, 0.0) / 32.0;
      CHECK(static_cast<double>(red(result, 48 + side * (9 + d), 32)) ==
            doctest::Approx(expected).epsilon(0.04).scale(1.0));
    }
  }
}

TEST_CASE("what moves behind something still does not reach over it") {
  ThreadPool pool{1};
  const MovingSquare scene = moving_square({24.0f, 0.0f}, 8.0f, 2.0f);
  for (const MotionFilter filter : kFilters) {
    const Image result =
        blurred({.shutter = 1.0f, .filter = filter}, scene.picture, scene.velocity, pool);
    for (int x = 0; x < 96; ++x) {
      if (std::abs(x - 48) >= 10) CHECK(red(result, x, 32) == 0.0f);
    }
  }
}

TEST_CASE("what moves before what is infinitely far blurs as before the farthest depth of a half") {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const Isa isa : available_isas()) {
    ThreadPool pool{1, isa};
    for (const MotionFilter filter : kFilters) {
      const MotionBlurSettings settings{.shutter = 1.0f, .filter = filter};
      for (const bool is_before : {true, false}) {
        const auto scene = [&](float far_m) {
          return moving_square({24.0f, 0.0f}, is_before ? 2.0f : far_m, is_before ? far_m : 2.0f);
        };
        const MovingSquare far = scene(65504.0f), farther = scene(infinity);
        const Image expected = blurred(settings, far.picture, far.velocity, pool);
        const Image result = blurred(settings, farther.picture, farther.velocity, pool);
        CHECK((red(result, 48 + 13, 32) > 0.15f) == is_before);
        for (int x = 0; x < 96; ++x) CHECK(red(result, x, 32) == red(expected, x, 32));
        CHECK(load_texel(result, is_before ? 0 : 48, 32).w == infinity);
      }
    }
  }
}

TEST_CASE("motion blur has the same bits in every kernel, for any number of threads") {
  ThreadPool scalar{1, Isa::scalar};
  const AnyPicture any = any_picture(83, 61, true);
  for (const MotionFilter filter : kFilters) {
    for (const int radius_px : {1, 7, 32}) {
      const MotionBlurSettings settings{
          .shutter = 1.0f, .samples = 5, .radius_px = radius_px, .filter = filter};
      for (const char* name : {"ieee", "d3d11", "llvmpipe"}) {
        const Profile profile = profile_named(name);
        const Image expected = blurred(settings, any.picture, any.velocity, scalar, profile);
        const Image simple = blurred_simply(1.0f, 5, any.picture, any.velocity, scalar, profile);
        for (const Isa isa : available_isas()) {
          ThreadPool pool{3, isa};
          CHECK(equal(blurred(settings, any.picture, any.velocity, pool, profile), expected));
          CHECK(equal(blurred_simply(1.0f, 5, any.picture, any.velocity, pool, profile), simple));
        }
      }
    }
  }
}

TEST_CASE("motion blur reads pictures whose rows begin anywhere") {
  ThreadPool pool{2};
  const AnyPicture any = any_picture(50, 40, false);
  std::vector<std::uint16_t> memory(40 * (4 * 50 + 1));
  const ImageView view = view_of(Format::rgba16f, memory.data(), 50, 40, (4 * 50 + 1) * 2);
  for (int y = 0; y < 40; ++y) {
    std::memcpy(row<std::uint16_t>(view, y).data(), row<std::uint16_t>(any.picture, y).data(),
                50 * 4 * sizeof(std::uint16_t));
  }
  Image result = make_image(Format::rgba16f, 50, 40);
  motion_blur({.shutter = 1.0f}, view, any.velocity, result, {}, pool);
  CHECK(equal(result, blurred({.shutter = 1.0f}, any.picture, any.velocity, pool)));
  motion_blur_along_own(1.0f, 6, view, any.velocity, result, {}, pool);
  CHECK(equal(result, blurred_simply(1.0f, 6, any.picture, any.velocity, pool)));
}

TEST_CASE("a tile's motion is its longest, and a neighbour at a corner must come near") {
  ThreadPool pool{2};
  const MotionBlurPass pass = pass_of({.shutter = 2.0f, .radius_px = 16});
  Image velocity = make_image(Format::rg16f, 40, 20);
  store_texel(velocity, 3, 5, {3.0f, 4.0f, 0.0f, 1.0f}, {});
  store_texel(velocity, 9, 9, {5.0f, 0.0f, 0.0f, 1.0f}, {});     // as long, and x is larger
  store_texel(velocity, 39, 19, {0.0f, 90.0f, 0.0f, 1.0f}, {});  // cut to the radius
  store_texel(velocity, 20, 2, {-2.0f, 2.0f, 0.0f, 1.0f}, {});
  Image spread = make_image(Format::rgba16f, 40, 20);
  motion_to_either_side(pass, velocity, spread, {}, pool);
  CHECK(load_texel(spread, 3, 5).z == doctest::Approx(0.2).epsilon(0.001));
  const MotionTiles tiles = longest_of_tiles(pass, spread, pool);
  REQUIRE(tiles.columns == 3);
  REQUIRE(tiles.rows == 2);
  CHECK(tiles.v[0] == glm::vec2{5.0f, 0.0f});
  CHECK(tiles.v[1] == glm::vec2{-2.0f, 2.0f});
  CHECK(tiles.v[5] == glm::vec2{0.0f, 16.0f});
  CHECK(tiles.v[3] == glm::vec2{0.0f});
  // Tile 1 lies at the upper right corner of tile 3, which is below tile 0 and left of tile 4: its
  // motion goes up right or down left.
  const MotionTiles one = longest_of_neighbours(tiles, MotionFilter::one_way);
  const MotionTiles two = longest_of_neighbours(tiles, MotionFilter::two_ways);
  CHECK(one.v[3] == glm::vec2{5.0f, 0.0f});
  CHECK(two.v[3] == glm::vec2{5.0f, 0.0f});
  CHECK(one.v[1] == glm::vec2{0.0f, 16.0f});  // tile 5 at its corner
  CHECK(two.v[1] == glm::vec2{5.0f, 0.0f});   // which moves straight down
}
