// Smooth edges of filtered pictures.

#include "dof/smooth_edges.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "tests/support/random.h"

using namespace softfocus;

namespace {

constexpr int kEdgeWidth = 24, kEdgeHeight = 18;

// A near surface to the left of a slanted line, and a far one: as one sample a pixel has them, with
// the part that the other has of each pixel.
struct EdgePicture {
  Image scene = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  Image other = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  Image coverage = make_image(Format::r8, kEdgeWidth, kEdgeHeight);

  DofInput input(const PixelCoc& coc) const {
    return {.scene = scene,
            .settings = {.coc = coc, .max_coc_px = 8.0f},
            .profile = {},
            .edges = {coverage, other}};
  }
};

constexpr glm::vec4 kNear{0.75f, 0.25f, 0.125f, 2.0f}, kFar{0.125f, 0.5f, 1.0f, 8.0f};

// Where the line is in a row, in pixels from the left.
float line_at(int y) { return 8.0f + 0.3f * static_cast<float>(y); }

EdgePicture edge_picture() {
  EdgePicture picture;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const float near_part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
      const bool shows_near = near_part >= 0.5f;
      store_texel(picture.scene, x, y, shows_near ? kNear : kFar, {});
      store_texel(picture.other, x, y, shows_near ? kFar : kNear, {});
      const float other_part = shows_near ? 1.0f - near_part : near_part;
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(other_part * 255.0f + 0.5f);
    }
  }
  return picture;
}

}  // namespace

TEST_CASE("smooth edges: what nothing blurs has each pixel's mean of its surfaces") {
  const EdgePicture picture = edge_picture();
  ThreadPool pool{2};
  for (const std::string_view method : {"pinhole", "two-pass", "disc-layers", "scatter"}) {
    const Image smooth = apply(*find_method(method), picture.input({0.0f, 4.0f}), pool);
    INFO(std::string{method});
    float worst = 0.0f;
    for (int y = 0; y < kEdgeHeight; ++y) {
      for (int x = 0; x < kEdgeWidth; ++x) {
        const float near_part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
        const glm::vec4 mean = kNear * near_part + kFar * (1.0f - near_part);
        const glm::vec4 texel = load_texel(smooth, x, y);
        for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(texel[k] - mean[k]));
        CHECK(texel.w == load_texel(picture.scene, x, y).w);
      }
    }
    CHECK(worst < 0.003f);
  }
}

TEST_CASE("smooth edges: a sharp surface before a blurred one has a smooth edge") {
  const EdgePicture picture = edge_picture();
  ThreadPool pool{2};
  const PixelCoc coc{6.0f, 2.0f};  // the near one is in focus
  const Image smooth = apply(*find_method("disc-layers"), picture.input(coc), pool);
  DofInput without = picture.input(coc);
  without.edges = {};
  const Image stairs = apply(*find_method("disc-layers"), without, pool);
  for (int y = 1; y + 1 < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const float near_part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
      const float texel = load_texel(smooth, x, y).x, before = load_texel(stairs, x, y).x;
      if (near_part == 0.0f || near_part == 1.0f) {
        CHECK(texel == before);
        continue;
      }
      // The blurred background beside the edge, as the filter has it.
      const float beside = load_texel(stairs, x + (near_part >= 0.5f ? 1 : 0), y).x;
      CHECK(texel ==
            doctest::Approx(kNear.x * near_part + beside * (1.0f - near_part)).epsilon(0.03));
    }
  }
}

TEST_CASE("smooth edges: a thing thinner than a pixel shows as far as it is in focus") {
  EdgePicture picture;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      store_texel(picture.scene, x, y, kFar, {});
      store_texel(picture.other, x, y, kNear, {});
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] = x == 9 ? 51 : 0;
    }
  }
  ThreadPool pool{1};
  const auto at_wire = [&](float radius, float focus) {
    const PixelCoc coc{radius, focus};
    return load_texel(apply(*find_method("pinhole"), picture.input(coc), pool), 9, 4).x;
  };
  CHECK(at_wire(0.0f, 4.0f) == doctest::Approx(kFar.x + 0.2f * (kNear.x - kFar.x)).epsilon(0.001));
  const Image blurred = apply(*find_method("two-pass"), picture.input({8.0f, 8.0f}), pool);
  CHECK(load_texel(blurred, 9, 4).x == doctest::Approx(kFar.x).epsilon(0.001));
}

TEST_CASE("smooth edges: surfaces of one depth keep the filter's colour, and mix their own") {
  EdgePicture picture;
  const glm::vec4 a{0.5f, 0.5f, 0.5f, 3.0f}, b{1.0f, 0.25f, 0.0f, 3.02f};
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      store_texel(picture.scene, x, y, x < 12 ? a : b, {});
      store_texel(picture.other, x, y, x < 12 ? b : a, {});
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] = x == 11 ? 102 : 0;
    }
  }
  ThreadPool pool{1};
  const glm::vec4 texel =
      load_texel(apply(*find_method("two-pass"), picture.input({0.0f, 1.0f}), pool), 11, 5);
  for (int k = 0; k < 3; ++k) {
    CHECK(texel[k] == doctest::Approx(a[k] + 0.4f * (b[k] - a[k])).epsilon(0.002));
  }
}

TEST_CASE(
    "smooth edges: what shadows change, the other surface takes from the pixel that shows it") {
  EdgePicture picture = edge_picture();
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const glm::vec4 lit = load_texel(picture.other, x, y);
      store_texel(picture.other, x, y, glm::vec4{glm::vec3{lit} * 2.0f, lit.w}, {});
    }
  }
  ThreadPool pool{2};
  const Image other = picture.other;
  take_shown_colours(picture.scene, picture.coverage, picture.other, pool);
  int taken = 0;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const glm::vec4 texel = load_texel(picture.other, x, y);
      if (row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] == 0) {
        CHECK(texel == load_texel(other, x, y));
        continue;
      }
      ++taken;
      CHECK(texel == (load_texel(picture.scene, x, y) == kNear ? kFar : kNear));
    }
  }
  CHECK(taken > 10);
}

TEST_CASE("smooth edges: the input is checked") {
  const EdgePicture picture = edge_picture();
  DofInput input = picture.input({1.0f, 2.0f});
  const Image result = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  CHECK(input_error(input, result) == nullptr);
  input.edges.coverage = picture.other;
  CHECK(input_error(input, result) != nullptr);
  input = picture.input({1.0f, 2.0f});
  input.edges.other = picture.coverage;
  CHECK(input_error(input, result) != nullptr);
  input = picture.input({1.0f, 2.0f});
  const std::vector<float> radii(std::size_t{kEdgeWidth} * kEdgeHeight);
  input.radii_px = radii;
  CHECK(input_error(input, result) != nullptr);
}
