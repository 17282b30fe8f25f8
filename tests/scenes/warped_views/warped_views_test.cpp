#include "scenes/warped_views/warped_views.h"

#include <doctest/doctest.h>

#include <cmath>

#include "dof/measure/flip.h"
#include "raster/images/texel.h"
#include "scenes/load/load_scene.h"
#include "scenes/warped_views/warped_colours.h"
#include "tests/support/lens_view_scenes.h"
#include "tests/support/random.h"

using namespace softfocus;
using test::Drawn;
using test::sample_scene;
using test::square_scene;

namespace {

constexpr PixelCoc kCircles{8.0f, 2.0f};

/// The depth whose circle is `radius_px`.
float depth_of(float radius_px) {
  return kCircles.focus_m / (1.0f - radius_px / kCircles.radius_at_infinity_px);
}

template <class TexelAt>
Image picture_of(int width, int height, const TexelAt& texel_at) {
  Image picture = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      store_texel<Format::rgba16f>(picture, x, y, texel_at(x, y), {});
    }
  }
  return picture;
}

struct Warped {
  WarpTile tile;
  WarpedColours sums;
};

Warped warped(const WarpSource& source, glm::vec2 shift, const Rectangle& area, Isa isa) {
  Warped made;
  warp_to(source, shift, area, made.tile, isa);
  for (std::vector<float>* plane : {&made.sums.red, &made.sums.green, &made.sums.blue}) {
    plane->assign(made.tile.radii.size(), 0.0f);
  }
  add_colours(source, shift, made.tile, made.sums, isa);
  return made;
}

/// Blocks at all depths, as a scene has them, and every colour another.
Image random_picture(int width, int height) {
  test::Random random{.state = 7};
  std::vector<float> depths;
  depths.reserve(64);
  for (int i = 0; i < 64; ++i) depths.push_back(depth_of(random.between(-7.0f, 7.5f)));
  return picture_of(width, height, [&](int x, int y) {
    const float slope = 0.002f * static_cast<float>(x % 13 + y % 5);
    const float depth = depths[static_cast<std::size_t>((x / 9 + 5 * (y / 7)) % 64)] + slope;
    return glm::vec4{random.between(0.0f, 2.0f), random.between(0.0f, 1.0f), 0.25f, depth};
  });
}

Drawn warped_scene(const Scene& scene, const Sampling& sampling, int side, ThreadPool& pool) {
  return sample_scene(scene, "warped-accumulation", sampling, side, side, pool, scene.lens.lens);
}

Scene warp_scene_named(const char* name) { return load_scene(name, scene_search_path({})); }

}  // namespace

TEST_CASE("a plane out of focus is moved by its circle's radius times the lens point") {
  ThreadPool pool{1};
  const Image picture = picture_of(40, 30, [](int x, int y) {
    return glm::vec4{static_cast<float>(x) / 64.0f, static_cast<float>(y) / 64.0f, 0.0f,
                     depth_of(4.0f)};
  });
  WarpSource source;
  source.point = {0.25, 0.25};
  set_source(source, picture, kCircles, {}, pool);
  const glm::vec2 shift = warp_shift(source, {0.75, -0.5});
  CHECK(shift == glm::vec2{0.5f, 0.75f});
  const Warped made = warped(source, shift, {8, 8, 32, 24}, pool.isa());
  CHECK(holes_of(made.tile).empty());
  for (int y = 8; y < 24; ++y) {
    for (int x = 8; x < 32; ++x) {
      const std::size_t at = tile_at(made.tile, x, y);
      REQUIRE(made.sums.red[at] == doctest::Approx((x - 2) / 64.0).epsilon(1e-3));
      REQUIRE(made.sums.green[at] == doctest::Approx((y - 3) / 64.0).epsilon(1e-3));
    }
  }
}

TEST_CASE("parts of a pixel are read between the texels") {
  ThreadPool pool{1};
  const Image picture = picture_of(32, 8, [](int x, int) {
    return glm::vec4{static_cast<float>(x) / 32.0f, 0.0f, 0.0f, depth_of(1.0f)};
  });
  WarpSource source;
  set_source(source, picture, kCircles, {}, pool);
  for (const float part : {0.25f, -0.4f, 0.5f}) {
    const Warped made = warped(source, {part, 0.0f}, {8, 2, 24, 6}, pool.isa());
    for (int x = 8; x < 24; ++x) {
      REQUIRE(made.sums.red[tile_at(made.tile, x, 4)] * 32.0f ==
              doctest::Approx(static_cast<float>(x) - part).epsilon(1e-3));
    }
  }
}

TEST_CASE("what is nearer is seen, and what it hid is a hole") {
  ThreadPool pool{1};
  const Image picture = picture_of(32, 8, [](int x, int) {
    const bool is_near = x >= 10 && x < 16;
    return glm::vec4{is_near ? 1.0f : 0.5f, 0.0f, 0.0f, is_near ? depth_of(-4.0f) : depth_of(0.0f)};
  });
  WarpSource source;
  set_source(source, picture, kCircles, {}, pool);
  const Warped made = warped(source, {-1.0f, 0.0f}, {0, 0, 32, 8}, pool.isa());
  CHECK(holes_of(made.tile).size() == std::size_t{4 * 8});
  for (int x = 0; x < 32; ++x) {
    CAPTURE(x);
    const std::size_t at = tile_at(made.tile, x, 4);
    const bool is_hole = x >= 10 && x < 14;  // 4 to the right of where it was
    CHECK((made.tile.radii[at] == kHoleRadius) == is_hole);
    CHECK(made.sums.red[at] == (is_hole ? 0.0f : x >= 14 && x < 20 ? 1.0f : 0.5f));
  }
}

TEST_CASE("a surface that is stretched has no cracks") {
  ThreadPool pool{1};
  const Image picture = picture_of(64, 16, [](int x, int) {
    return glm::vec4{0.5f, 0.5f, 0.5f, depth_of(0.1f * static_cast<float>(x))};
  });
  WarpSource source;
  set_source(source, picture, kCircles, {}, pool);
  const Warped made = warped(source, {1.0f, 0.0f}, {0, 0, 64, 16}, pool.isa());
  CHECK(holes_of(made.tile).empty());
}

TEST_CASE("where two surfaces part by a pixel, the farther is put once more beside itself") {
  ThreadPool pool{1};
  const Image picture = picture_of(32, 16, [](int x, int y) {
    const bool is_near = x >= 10 || y >= 8;
    return glm::vec4{is_near ? 1.0f : 0.0f, static_cast<float>(y) / 16.0f, 0.0f,
                     is_near ? depth_of(0.0f) : depth_of(1.0f)};
  });
  WarpSource source;
  set_source(source, picture, kCircles, {}, pool);
  // The far one goes one up and one to the left, away from the near one.
  const Warped made = warped(source, {-1.0f, -1.0f}, {0, 0, 32, 16}, pool.isa());
  for (int y = 1; y < 7; ++y) {
    const std::size_t at = tile_at(made.tile, 9, y);
    REQUIRE(made.sums.red[at] == 0.0f);
    REQUIRE(made.sums.green[at] == static_cast<float>(y + 1) / 16.0f);
  }
  const std::size_t below = tile_at(made.tile, 8, 7);
  CHECK(made.sums.red[below] == 0.0f);
  CHECK(made.sums.green[below] == 7.0f / 16.0f);
  // In the corner it is beside neither.
  CHECK(made.tile.radii[tile_at(made.tile, 9, 7)] == kHoleRadius);
}

TEST_CASE("warped pictures have the same bits on every vector unit and in every tile") {
  ThreadPool pool{1};
  const Image picture = random_picture(150, 90);
  const std::vector<glm::vec2> shifts{{0.4f, -0.3f}, {-0.55f, 0.1f}, {0.0f, 0.9f}, {0.02f, 0.01f}};
  for (const Isa isa : available_isas()) {
    CAPTURE(isa_name(isa));
    ThreadPool scalar{1, Isa::scalar}, own{1, isa};
    WarpSource expected, source;
    set_source(expected, picture, kCircles, warp_sharpening(shifts), scalar);
    set_source(source, picture, kCircles, warp_sharpening(shifts), own);
    CHECK(source.red == expected.red);
    CHECK(source.blue == expected.blue);
    CHECK(source.radii == expected.radii);
    for (const glm::vec2 shift : shifts) {
      const Warped whole = warped(expected, shift, {0, 0, 150, 90}, Isa::scalar);
      for (const Rectangle& area : {Rectangle{0, 0, 150, 90}, Rectangle{37, 21, 118, 60}}) {
        const Warped part = warped(source, shift, area, isa);
        bool same = true;
        for (int y = area.y_begin; y < area.y_end; ++y) {
          for (int x = area.x_begin; x < area.x_end; ++x) {
            const std::size_t a = tile_at(whole.tile, x, y), b = tile_at(part.tile, x, y);
            same = same && whole.tile.radii[a] == part.tile.radii[b] &&
                   whole.sums.red[a] == part.sums.red[b] &&
                   whole.sums.green[a] == part.sums.green[b];
          }
        }
        CHECK(same);
      }
    }
  }
}

TEST_CASE("sharpening takes away what reading between texels adds") {
  // Half a pixel for each radius: at |r| = 1 all views read in the middle.
  const std::vector<glm::vec2> shifts{{0.5f, 0.5f}, {-0.5f, 0.5f}};
  const WarpSharpening sharpening = warp_sharpening(shifts);
  CHECK(sharpening.amounts[16] == doctest::Approx(0.125).epsilon(0.01));
  CHECK(sharpening.amounts[0] < 0.01f);
  CHECK(sharpening.most_shift == 0.5f);
  ThreadPool pool{1};
  // A parabola's second difference is 2: each way of reading at a half adds 1/4 of it.
  const Image picture = picture_of(32, 16, [](int x, int) {
    const float from_middle = (static_cast<float>(x) - 16.0f) / 16.0f;
    return glm::vec4{from_middle * from_middle, 0.0f, 0.0f, depth_of(1.0f)};
  });
  WarpSource source;
  set_source(source, picture, kCircles, sharpening, pool);
  const Warped made = warped(source, {0.5f, 0.0f}, {4, 4, 28, 12}, pool.isa());
  for (int x = 6; x < 26; ++x) {
    const double exact = (x - 16.5) / 16.0;
    REQUIRE(made.sums.red[tile_at(made.tile, x, 8)] ==
            doctest::Approx(exact * exact).epsilon(0.002).scale(1.0));
  }
}

TEST_CASE(
    "warped accumulation: what lies in the plane of focus is as sharp as the pinhole has it") {
  ThreadPool pool{2};
  const Scene scene = square_scene(test::kTestLens.focus_m, 0.8);
  const Drawn drawn =
      sample_scene(scene, "warped-accumulation", {.samples = 16, .drawn_views = 3}, 65, 65, pool);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
  CHECK(drawn.sampled.samples == 16);
}

TEST_CASE("warped accumulation: with as many drawn views as samples it is accumulation") {
  ThreadPool pool{2};
  const Scene scene = warp_scene_named("figures");
  const Sampling sampling{.samples = 7, .drawn_views = 7};
  const Drawn drawn = warped_scene(scene, sampling, 70, pool);
  const Drawn other = sample_scene(scene, "accumulation", sampling, 70, 70, pool, scene.lens.lens);
  CHECK(equal(drawn.sampled.picture, other.sampled.picture));
}

TEST_CASE("warped accumulation: 64 views from 7 are nearer to the truth than those 7" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  constexpr int kSide = 160;
  for (const char* name : {"sphere-world", "portrait"}) {
    CAPTURE(std::string{name});
    const Scene scene = warp_scene_named(name);
    const Image truth =
        sample_scene(scene, "accumulation", {.samples = 512}, kSide, kSide, pool, scene.lens.lens)
            .sampled.picture;
    const auto flip = [&](const char* method, const Sampling& sampling) {
      return mean_flip(truth,
                       sample_scene(scene, method, sampling, kSide, kSide, pool, scene.lens.lens)
                           .sampled.picture,
                       pool);
    };
    const double warped_64 = flip("warped-accumulation", {.samples = 64, .drawn_views = 7});
    const double drawn_7 = flip("accumulation", {.samples = 7});
    MESSAGE(warped_64 << " of " << drawn_7);
    CHECK(warped_64 < 0.6 * drawn_7);
  }
}

TEST_CASE("warped accumulation: the same bits on any number of threads; few pixels are unseen") {
  const Scene scene = warp_scene_named("near-fence");
  const Sampling sampling{.samples = 20, .drawn_views = 3};
  ThreadPool one{1}, three{3};
  const Drawn drawn = warped_scene(scene, sampling, 96, one);
  CHECK(equal(drawn.sampled.picture, warped_scene(scene, sampling, 96, three).sampled.picture));
  MESSAGE(*drawn.sampled.unseen);
  CHECK(*drawn.sampled.unseen > 0.0);
  CHECK(*drawn.sampled.unseen < 0.02);
}
