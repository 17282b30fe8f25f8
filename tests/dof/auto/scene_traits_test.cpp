#include "dof/auto/scene_traits.h"

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dof/auto/depth_range.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kSide = 160;

// In focus at 2 m; the horizon's circle has a radius of 12 pixels, and one at 1 m of -12.
constexpr PixelCoc kCoc{12.0f, 2.0f};

template <class ColourAt, class DepthAt>
Image picture_of(const ColourAt& colour_at, const DepthAt& depth_at) {
  Image image = make_image(Format::rgba16f, kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const float grey = colour_at(x, y);
      store_texel(image, x, y, {grey, grey, grey, depth_at(x, y)}, {});
    }
  }
  return image;
}

SceneTraits traits_of(const Image& image) {
  ThreadPool pool{2};
  return scene_traits(image, kCoc, pool);
}

float checks(int x, int y) { return ((x / 4) + (y / 4)) % 2 == 0 ? 1.0f : 0.0f; }

}  // namespace

TEST_CASE("scene traits: all in focus, there is no blur and nothing to lose") {
  const SceneTraits traits = traits_of(picture_of(checks, [](int, int) { return 2.0f; }));
  CHECK(largest_px(traits) == 0.0f);
  CHECK(traits.blurred_share == 0.0f);
  CHECK(traits.blur == 0.0f);
  for (const RadiusTraits& of : traits.by_radius) {
    CHECK(of.lost + of.blurred + of.near_edges + of.far_edges == 0.0f);
  }
}

TEST_CASE("scene traits: the range of circles is of every pixel, and by depth alone") {
  Image image = picture_of(checks, [](int, int) { return 2.0f; });
  store_texel(image, 17, 3, {0, 0, 0, 1.0f}, {});  // one pixel, which no grid meets
  store_texel(image, 151, 140, {0, 0, 0, 4.0f}, {});
  const SceneTraits traits = traits_of(image);
  CHECK(traits.nearest_px == -12.0f);
  CHECK(traits.farthest_px == 6.0f);
  CHECK(largest_px(traits) == 12.0f);
}

TEST_CASE("scene traits: a ramp of depth has no edges, a step has, before the focus alone") {
  const auto grey = [](int x, int) { return x < kSide / 2 ? 0.9f : 0.1f; };
  const auto ramp = [](int x, int) { return 1.6f + 0.002f * static_cast<float>(x); };
  const auto far_step = [](int x, int) { return x < kSide / 2 ? 2.0f : 8.0f; };
  const auto near_step = [](int x, int) { return x < kSide / 2 ? 1.0f : 2.0f; };
  const SceneTraits of_ramp = traits_of(picture_of(grey, ramp));
  const SceneTraits of_far = traits_of(picture_of(grey, far_step));
  const SceneTraits of_near = traits_of(picture_of(grey, near_step));
  for (std::size_t i = 0; i < kFilterRadiiPx.size(); ++i) {
    CHECK(of_ramp.by_radius[i].near_edges == 0.0f);
    CHECK(of_ramp.by_radius[i].far_edges == 0.0f);
    CHECK(of_far.by_radius[i].near_edges == 0.0f);
    CHECK(of_near.by_radius[i].far_edges == 0.0f);
  }
  CHECK(of_near.by_radius[2].near_edges > 0.001f);
  const auto blurred_step = [](int x, int) { return x < kSide / 2 ? 4.0f : 8.0f; };
  const SceneTraits of_blurred = traits_of(picture_of(grey, blurred_step));
  CHECK(of_blurred.by_radius[2].far_edges > 0.001f);
  CHECK(of_blurred.by_radius[2].near_edges == 0.0f);
  CHECK(of_near.blurred_share == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("scene traits: what has one colour loses nothing, however blurred") {
  const SceneTraits traits =
      traits_of(picture_of([](int, int) { return 0.5f; }, [](int, int) { return 8.0f; }));
  CHECK(traits.blurred_share == 1.0f);
  CHECK(traits.blur < 1e-4f);
  CHECK(traits.ghosts[0] < 1e-4f);
}

TEST_CASE("scene traits: black and white checks far out of focus become grey") {
  const SceneTraits traits = traits_of(picture_of(checks, [](int, int) { return 8.0f; }));
  // Each point is 0 or 1 and becomes about a half: F(1/2) = 0.595.
  CHECK(traits.blur == doctest::Approx(0.595).epsilon(0.12));
  // Ghosts are the fainter the more there are, and once they run into one, by 1 / N.
  for (std::size_t i = 1; i < kSampleCounts.size(); ++i) {
    CHECK(traits.ghosts[i] < traits.ghosts[i - 1]);
  }
  CHECK(traits.ghosts[8] == doctest::Approx(0.5f * traits.ghosts[7]));
}

TEST_CASE("scene traits: a wider filter gives more of an edge's blur, and all of it in the end") {
  const auto half = [](int x, int) { return x < kSide / 2 ? 1.0f : 0.0f; };
  const SceneTraits traits = traits_of(picture_of(half, [](int, int) { return 8.0f; }));  // 9 px
  for (std::size_t i = 1; i < kFilterRadiiPx.size(); ++i) {
    CHECK(traits.by_radius[i].lost <= traits.by_radius[i - 1].lost);
    CHECK(traits.by_radius[i].blurred >= traits.by_radius[i - 1].blurred);
  }
  CHECK(traits.by_radius[0].lost > 0.01f);
  CHECK(traits.by_radius[3].lost == 0.0f);
  CHECK(traits.by_radius[3].blurred == traits.blur);
}

TEST_CASE("scene traits: depths that are none lie beyond the focus, or before it") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto with = [](float depth) {
    Image image = picture_of(checks, [](int, int) { return 2.0f; });
    store_texel(image, 80, 80, {1, 1, 1, depth}, {});
    return traits_of(image);
  };
  CHECK(with(kInfinity).farthest_px == 1024.0f);
  CHECK(with(std::numeric_limits<float>::quiet_NaN()).farthest_px == 1024.0f);
  CHECK(with(0.0f).nearest_px == -1024.0f);
}

TEST_CASE("scene traits: the same bits for any number of threads and on every vector unit" *
          doctest::test_suite("threads")) {
  for (const auto& [width, height] : {std::pair{301, 77}, std::pair{16, 9}, std::pair{1, 1}}) {
    const Image image = random_scene_image(width, height, 5);
    ThreadPool one{1, Isa::scalar};
    const SceneTraits expected = scene_traits(image, kCoc, one);
    for (const Isa isa : available_isas()) {
      for (const int threads : {1, 3}) {
        ThreadPool pool{threads, isa};
        const SceneTraits traits = scene_traits(image, kCoc, pool);
        using Bits = std::array<std::uint32_t, sizeof(SceneTraits) / sizeof(std::uint32_t)>;
        CHECK(std::bit_cast<Bits>(traits) == std::bit_cast<Bits>(expected));
      }
    }
  }
}

TEST_CASE("depth range: halves in the order of their bits, wherever they stand") {
  for (const int width : {1, 7, 16, 33}) {
    Image image = make_image(Format::rgba16f, width, 40);
    set_depth(image, [](int, int) { return 3.0f; });
    for (const Isa isa : available_isas()) {
      for (const int x : {0, width / 2, width - 1}) {
        Image marked = image;
        store_texel(marked, x, 37, {0, 0, 0, 5.0f}, {});
        store_texel(marked, width - 1 - x, 2, {9, 9, 9, 0.25f}, {});
        ThreadPool pool{2, isa};
        const DepthRange range = depth_range(marked, pool);
        CHECK(range.least == 0x3400);  // 0.25
        CHECK(range.most == 0x4500);   // 5
      }
    }
  }
}
