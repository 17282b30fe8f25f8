// Several samples a pixel: each sample has what one sample a pixel shows of a scene that is moved.

#include "raster/pipeline/multisample.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;

namespace {

constexpr int kSampledWidth = 80, kSampledHeight = 70;  // four tiles

// The first varying, which is flat, as a colour.
struct FlatColour {
  static constexpr std::array kInterpolation{Interpolation::flat};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<1>& f) const {
    return {{glm::vec4{f.varyings[0], f.varyings[0], f.varyings[0], 1.0f}}, false};
  }
};

// The varying as alpha.
template <bool centroid>
struct AlphaOfVarying {
  static constexpr std::array kInterpolation{Interpolation::linear};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  static constexpr bool kCentroid = centroid;
  FragmentOutput<1> operator()(const Fragment<1>& f) const {
    return {{glm::vec4{1.0f, 1.0f, 1.0f, f.varyings[0]}}, false};
  }
};

// A point of the window in 1/256 pixel.
struct Corner {
  int x, y;
  float z;
};

std::vector<Corner> random_corners(test::Random& random, int triangles, int size) {
  std::vector<Corner> corners;
  for (int t = 0; t < triangles; ++t) {
    const int x = random.whole(0, kSampledWidth * 256), y = random.whole(0, kSampledHeight * 256);
    for (int i = 0; i < 3; ++i) {
      corners.push_back({x + random.whole(-size, size), y + random.whole(-size, size),
                         random.between(-0.9f, 0.9f)});
    }
  }
  return corners;
}

struct Sampled {
  Image colour, depth;
};

Sampled cleared(int samples) {
  Sampled images{make_image(Format::rgba16f, kSampledWidth, kSampledHeight * samples),
                 make_image(Format::r32f, kSampledWidth, kSampledHeight * samples)};
  return images;
}

template <class FragmentStage>
Sampled draw_sampled(const std::vector<VertexOutput<1>>& vertices, int samples, DrawState state,
                     const FragmentStage& stage) {
  Sampled images = cleared(samples);
  RenderPass pass;
  pass.targets = {
      .colour = {&images.colour}, .depth = &images.depth, .stencil = {}, .samples = samples};
  pass.clear_colour = glm::vec4{0.0f};
  pass.clear_depth = 1.0f;
  state.cull = Cull::none;
  const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
  draw(pass, state, indices, static_cast<std::uint32_t>(vertices.size()),
       test::ListedVertices<1>{&vertices}, stage);
  ThreadPool pool{2};
  finish(pass, pool);
  return images;
}

// Corners moved by a step of the subpixel grid, each triangle with its number.
std::vector<VertexOutput<1>> moved(const std::vector<Corner>& corners, const glm::ivec2& by) {
  std::vector<VertexOutput<1>> vertices;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec2 window{static_cast<float>(corners[i].x + by.x) / 256.0f,
                           static_cast<float>(corners[i].y + by.y) / 256.0f};
    vertices.push_back({test::at_window(window, kSampledWidth, kSampledHeight, corners[i].z),
                        {static_cast<float>(i / 3 + 1)}});
  }
  return vertices;
}

}  // namespace

TEST_CASE("samples lie in different rows and columns of a pixel, about its centre") {
  for (const int samples : {4, 8}) {
    std::set<int> columns, rows;
    glm::ivec2 sum{};
    for (const glm::ivec2& place : sample_places(samples)) {
      columns.insert(place.x);
      rows.insert(place.y);
      sum += place;
      CHECK(std::max(std::abs(place.x), std::abs(place.y)) <= sample_reach(samples));
    }
    CHECK(columns.size() == static_cast<std::size_t>(samples));
    CHECK(rows.size() == static_cast<std::size_t>(samples));
    CHECK(sum.x == 0);
    CHECK(sum.y == 0);
  }
}

TEST_CASE("a sample shows what a pixel's centre shows of triangles moved by the sample's place") {
  test::Random random{701};
  for (const int size : {150, 600, 5000, 40000}) {
    const std::vector<Corner> corners = random_corners(random, fewer(300), size);
    for (const int samples : {4, 8}) {
      const Sampled all = draw_sampled(moved(corners, {}), samples, {}, FlatColour{});
      for (int s = 0; s < samples; ++s) {
        const glm::ivec2 place = sample_places(samples)[static_cast<std::size_t>(s)];
        const Sampled one = draw_sampled(moved(corners, {-place.x, -place.y}), 1, {}, FlatColour{});
        int different = 0;
        for (int y = 0; y < kSampledHeight; ++y) {
          for (int x = 0; x < kSampledWidth; ++x) {
            different += load_texel(all.colour, x, y * samples + s) != load_texel(one.colour, x, y);
            different += load_texel(all.depth, x, y * samples + s) != load_texel(one.depth, x, y);
          }
        }
        INFO("size ", size, ", sample ", s, " of ", samples);
        CHECK(different == 0);
      }
    }
  }
}

TEST_CASE("alpha becomes coverage: sample s of n where it is above s / n, and all of NaN") {
  for (const int samples : {4, 8}) {
    for (const float alpha : {0.0f, 0.01f, 0.25f, 0.3f, 0.5f, 0.7f, 0.75f, 1.0f,
                              std::numeric_limits<float>::quiet_NaN()}) {
      std::vector<VertexOutput<1>> vertices;
      for (const glm::vec2& at : {glm::vec2{0, 0}, glm::vec2{0, 300}, glm::vec2{300, 0}}) {
        vertices.push_back({test::at_window(at, kSampledWidth, kSampledHeight, 0.0f), {alpha}});
      }
      DrawState state;
      state.alpha_to_coverage = true;
      const Sampled drawn = draw_sampled(vertices, samples, state, AlphaOfVarying<false>{});
      for (int s = 0; s < samples; ++s) {
        const bool covered = load_texel(drawn.colour, 7, 9 * samples + s).x != 0.0f;
        const float least = static_cast<float>(s) / static_cast<float>(samples);
        INFO("alpha ", alpha, ", sample ", s, " of ", samples);
        CHECK(covered == (std::isnan(alpha) || alpha > least));
        CHECK((load_texel(drawn.depth, 7, 9 * samples + s).x < 1.0f) == covered);
      }
    }
  }
}

TEST_CASE("centroid varyings come from a covered sample where the centre is not covered") {
  // Its varying is the distance from the right side in pixels: below 0 beyond it.
  std::vector<VertexOutput<1>> vertices;
  for (const glm::vec2& at :
       {glm::vec2{30.25f, -200}, glm::vec2{30.25f, 300}, glm::vec2{-200, 40}}) {
    vertices.push_back({test::at_window(at, kSampledWidth, kSampledHeight, 0.0f), {30.25f - at.x}});
  }
  const Sampled centre = draw_sampled(vertices, 4, {}, AlphaOfVarying<false>{});
  const Sampled centroid = draw_sampled(vertices, 4, {}, AlphaOfVarying<true>{});
  // Sample 2 alone is covered there, 3/8 pixel to the left of the centre.
  const glm::vec4 extrapolated = load_texel(centre.colour, 30, 20 * 4 + 2);
  const glm::vec4 within = load_texel(centroid.colour, 30, 20 * 4 + 2);
  CHECK(extrapolated.w == doctest::Approx(-0.25));
  CHECK(within.w == doctest::Approx(0.125));
  CHECK(load_texel(centroid.colour, 30, 20 * 4 + 1).w == 0.0f);
  CHECK(load_texel(centroid.colour, 29, 20 * 4).w == load_texel(centre.colour, 29, 20 * 4).w);
}

TEST_CASE("a resolved pixel is the mean of its samples") {
  Image samples = make_image(Format::rgba16f, 3, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 3; ++x) {
      store_texel(samples, x, y, glm::vec4{x, y, x * y, 1.0f}, {});
    }
  }
  const Image resolved = resolve(samples, 4, {});
  REQUIRE(resolved.height == 2);
  CHECK(load_texel(resolved, 2, 0) == glm::vec4{2.0f, 1.5f, 3.0f, 1.0f});
  CHECK(load_texel(resolved, 1, 1) == glm::vec4{1.0f, 5.5f, 5.5f, 1.0f});
}

TEST_CASE("a pixel's surfaces add up to the mean of its samples, and mix no depths") {
  test::Random random{702};
  for (int i = 0; i < 2000; ++i) {
    const std::size_t count = random.whole(0, 1) == 0 ? 4 : 8;
    const float near_m = random.between(0.5f, 20.0f), far_m = near_m * random.between(1.1f, 50.0f);
    std::vector<glm::vec4> samples;
    glm::vec3 sum{0.0f};
    int near_count = 0;
    for (std::size_t s = 0; s < count; ++s) {
      const bool is_near = random.whole(0, 1) == 0;
      near_count += is_near;
      samples.push_back({random.between(0.0f, 1.0f), random.between(0.0f, 1.0f),
                         random.between(0.0f, 1.0f),
                         (is_near ? near_m : far_m) * random.between(1.0f, 1.01f)});
      sum += glm::vec3{samples.back()};
    }
    const PixelSurfaces surfaces = surfaces_of(samples);
    const auto all = static_cast<float>(count);
    const float other = static_cast<float>(surfaces.other_samples) / all;
    CHECK(other <= 0.5f);
    for (int k = 0; k < 3; ++k) {
      const float mean = surfaces.texel[k] * (1.0f - other) + surfaces.other[k] * other;
      CHECK(mean == doctest::Approx(sum[k] / all).epsilon(1e-5));
    }
    const int smaller = std::min(near_count, static_cast<int>(count) - near_count);
    CHECK(surfaces.other_samples == smaller);
    const bool shows_near = 2 * near_count >= static_cast<int>(count);
    CHECK(surfaces.texel.w ==
          doctest::Approx((shows_near ? near_m : far_m) * 1.005).epsilon(0.006));
    if (smaller > 0) {
      CHECK(surfaces.other.w ==
            doctest::Approx((shows_near ? far_m : near_m) * 1.005).epsilon(0.006));
    }
  }
}

TEST_CASE("samples of one depth are one surface, and equal ones stay as they are") {
  const glm::vec4 texel{-0.0f, 0.3f, 0.1f, 4.0f};
  const std::array<glm::vec4, 4> equal{texel, texel, texel, texel};
  CHECK(surfaces_of(equal).other_samples == 0);
  CHECK(std::signbit(surfaces_of(equal).texel.x));
  const std::array<glm::vec4, 4> sloping{
      glm::vec4{0, 0, 0, 4.0f}, {1, 0, 0, 4.05f}, {0, 1, 0, 4.1f}, {0, 0, 1, 4.12f}};
  CHECK(surfaces_of(sloping).other_samples == 0);
  CHECK(surfaces_of(sloping).texel.x == 0.25f);
}
