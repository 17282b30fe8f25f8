// Several samples a pixel: each sample has what one sample a pixel shows of a scene that is moved.

#include "raster/pipeline/multisample.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec3.hpp>
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
    const std::size_t triangle = i / 3;
    const glm::vec2 window{static_cast<float>(corners[i].x + by.x) / 256.0f,
                           static_cast<float>(corners[i].y + by.y) / 256.0f};
    vertices.push_back({test::at_window(window, kSampledWidth, kSampledHeight, corners[i].z),
                        {static_cast<float>(triangle + 1)}});
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

TEST_CASE("stencil values are each sample's own") {
  test::Random random{703};
  const std::vector<Corner> mask = random_corners(random, 40, 3000);
  const std::vector<Corner> all{
      {-100000, -100000, 0.5f}, {100000, -100000, 0.5f}, {0, 200000, 0.5f}};
  for (const int samples : {4, 8}) {
    const Sampled expected = draw_sampled(moved(mask, {}), samples, {}, FlatColour{});
    Sampled images = cleared(samples);
    Image stencil = make_image(Format::r8, kSampledWidth, kSampledHeight * samples);
    RenderPass pass;
    pass.targets = {.colour = {&images.colour},
                    .depth = &images.depth,
                    .stencil = &stencil,
                    .behind = {},
                    .samples = samples};
    DrawState marks, marked;
    marks.cull = marked.cull = Cull::none;
    marks.depth = marked.depth = std::nullopt;
    const StencilFace set{.reference = 7, .on_pass = StencilOp::replace};
    marks.stencil = StencilState{set, set};
    marks.colour[0].write = {false, false, false, false};
    const StencilFace test{.test = Compare::equal, .reference = 7};
    marked.stencil = StencilState{test, test};
    const auto of_mask = moved(mask, {}), of_all = moved(all, {});
    const auto mask_indices = test::indices_up_to(of_mask.size());
    const auto all_indices = test::indices_up_to(of_all.size());
    draw(pass, marks, mask_indices, static_cast<std::uint32_t>(of_mask.size()),
         test::ListedVertices<1>{&of_mask}, FlatColour{});
    draw(pass, marked, all_indices, 3, test::ListedVertices<1>{&of_all}, FlatColour{});
    ThreadPool pool{1};
    finish(pass, pool);
    int marked_samples = 0, different = 0;
    for (int y = 0; y < images.colour.height; ++y) {
      for (int x = 0; x < kSampledWidth; ++x) {
        const bool is_covered = load_texel(expected.colour, x, y).x > 0.0f;
        different += (load_texel(images.colour, x, y).x > 0.0f) != is_covered;
        marked_samples += is_covered;
      }
    }
    CHECK(different == 0);
    CHECK(marked_samples > 1000);
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

TEST_CASE(
    "the other surface of a pixel is of one depth, and has the mean of its samples' colours") {
  test::Random random{702};
  for (int i = 0; i < 2000; ++i) {
    const float centre_m = random.between(0.5f, 20.0f);
    const bool is_farther = random.whole(0, 1) == 0;
    const float apart = random.between(1.1f, 50.0f);
    const float other_m = is_farther ? centre_m * apart : centre_m / apart;
    std::vector<glm::vec4> samples;
    glm::vec3 sum{0.0f};
    int count = 0;
    for (int s = 0; s < 8; ++s) {
      const bool is_other = s == 0 || random.whole(0, 1) == 0;
      count += is_other;
      samples.push_back({random.between(0.0f, 1.0f), random.between(0.0f, 1.0f),
                         random.between(0.0f, 1.0f), is_other ? other_m : centre_m * 1.01f});
      if (is_other) sum += glm::vec3{samples.back()};
    }
    const OtherSurface other = other_surface(centre_m, samples);
    CHECK(other.samples == count);
    CHECK(other.texel.w == other_m);
    for (int k = 0; k < 3; ++k) {
      CHECK(other.texel[k] == doctest::Approx(sum[k] / static_cast<float>(count)).epsilon(1e-5));
    }
  }
}

TEST_CASE("samples at the centre's depth are all of the other surface; a third one is left out") {
  const std::array<glm::vec4, 3> edge{glm::vec4{1, 0, 0, 4.0f}, {0, 1, 0, 4.02f}, {0, 1, 0, 4.02f}};
  CHECK(other_surface(4.0f, edge).samples == 3);
  CHECK(other_surface(4.0f, edge).texel.w == 4.02f);
  // Of a distant floor at 60 and 80 m, and a thing at 2 m before it.
  const std::array<glm::vec4, 3> three{
      glm::vec4{1, 0, 0, 60.0f}, {0, 1, 0, 2.0f}, {0, 0, 1, 80.0f}};
  CHECK(other_surface(70.0f, three).samples == 1);
  CHECK(other_surface(70.0f, three).texel == glm::vec4{0, 1, 0, 2.0f});
}

TEST_CASE("edges from a multisampled image are the samples of another depth") {
  Image picture = make_image(Format::rgba16f, 3, 1), samples = make_image(Format::rgba16f, 3, 4);
  Image other = make_image(Format::rgba16f, 3, 1), coverage = make_image(Format::r8, 3, 1);
  for (int x = 0; x < 3; ++x) {
    store_texel(picture, x, 0, {1, 1, 1, 2}, {});
    for (int s = 0; s < 4; ++s) {
      store_texel(samples, x, s, s < x ? glm::vec4{0, 0.5f, 0, 8} : glm::vec4{0.25f, 1, 1, 2}, {});
    }
  }
  ThreadPool pool{1};
  find_edges(picture, samples, {4, &other, &coverage}, {}, pool);
  CHECK(row<std::uint8_t>(coverage, 0)[0] == 0);
  CHECK(row<std::uint8_t>(coverage, 0)[1] == 64);
  CHECK(row<std::uint8_t>(coverage, 0)[2] == 128);
  CHECK(load_texel(other, 2, 0) == glm::vec4{0, 0.5f, 0, 8});
}
