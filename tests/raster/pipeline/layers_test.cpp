// A pass that peels against sorting all fragments of each pixel.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

constexpr int kLayersWidth = 70, kLayersHeight = 66;  // four tiles
constexpr float kLayersClear = 0.125f;

struct DepthAndColour {
  float depth;
  glm::vec4 colour;
};

// Its varyings as a colour; if it discards, only where the first is not negative.
template <bool discards>
struct HoledColour {
  static constexpr std::array kInterpolation{Interpolation::linear, Interpolation::linear,
                                             Interpolation::linear, Interpolation::flat};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = discards;
  FragmentOutput<1> operator()(const Fragment<4>& f) const {
    return {{glm::vec4{f.varyings[0], f.varyings[1], f.varyings[2], f.varyings[3]}},
            discards && f.varyings[0] < 0.0f};
  }
};

DrawState both_sides() {
  DrawState state;
  state.cull = Cull::none;
  return state;
}

// Triangles of few depths, so that many are equal, level or sloping, each with its own number.
std::vector<VertexOutput<4>> stacked_triangles(int count, std::uint64_t seed) {
  test::Random random{seed};
  std::vector<VertexOutput<4>> vertices;
  for (int t = 0; t < count; ++t) {
    const double level = 0.25 * random.whole(0, 3) - 0.5;
    const bool slopes = random.whole(0, 2) == 0;
    for (int i = 0; i < 3; ++i) {
      const glm::vec2 at{static_cast<float>(random.between(-10.0, kLayersWidth + 10.0)),
                         static_cast<float>(random.between(-10.0, kLayersHeight + 10.0))};
      const double z = slopes ? random.between(-0.9, 0.9) : level;
      VertexOutput<4> vertex{
          test::at_window(at, kLayersWidth, kLayersHeight, static_cast<float>(z)), {}};
      for (float& value : vertex.varyings) value = random.between(-1.0f, 1.0f);
      vertex.varyings[3] = static_cast<float>(t + 1);
      vertices.push_back(vertex);
    }
  }
  return vertices;
}

struct DrawnLayers {
  std::vector<Image> colour, depth;
};

template <class Stage>
DrawnLayers peeled(const std::vector<VertexOutput<4>>& vertices, std::size_t layers, Stage stage,
                   int threads = 1, std::optional<float> behind_before = {}) {
  DrawnLayers drawn;
  for (std::size_t i = 0; i < layers; ++i) {
    drawn.colour.push_back(make_image(Format::rgba16f, kLayersWidth, kLayersHeight));
    drawn.depth.push_back(make_image(Format::r32f, kLayersWidth, kLayersHeight));
  }
  RenderPass pass;
  pass.targets.colour[0] = &drawn.colour[0];
  pass.targets.depth = &drawn.depth[0];
  for (std::size_t i = 1; i < layers; ++i) {
    pass.targets.behind[i - 1] = {&drawn.colour[i], &drawn.depth[i]};
  }
  pass.clear_colour = glm::vec4{kLayersClear};
  pass.clear_depth = 1.0f;
  pass.behind_before = behind_before;
  const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
  draw(pass, both_sides(), indices, static_cast<std::uint32_t>(vertices.size()),
       test::ListedVertices<4>{&vertices}, stage);
  ThreadPool pool{threads};
  finish(pass, pool);
  return drawn;
}

// The oracle: each triangle alone gives its fragments; a pixel's are sorted by depth, and stay in
// the order of submission where that is equal.
template <class Stage>
DrawnLayers sorted(const std::vector<VertexOutput<4>>& vertices, std::size_t layers, Stage stage) {
  std::vector<std::vector<DepthAndColour>> fragments(kLayersWidth * kLayersHeight);
  for (std::size_t t = 0; t + 2 < vertices.size(); t += 3) {
    const std::vector<VertexOutput<4>> triangle{vertices[t], vertices[t + 1], vertices[t + 2]};
    const DrawnLayers alone = peeled(triangle, 1, stage);
    for (int y = 0; y < kLayersHeight; ++y) {
      for (int x = 0; x < kLayersWidth; ++x) {
        const float depth = row<float>(alone.depth[0], y)[static_cast<std::size_t>(x)];
        if (depth == 1.0f) continue;
        fragments[static_cast<std::size_t>(y * kLayersWidth + x)].push_back(
            {depth, load_texel(alone.colour[0], x, y)});
      }
    }
  }
  DrawnLayers result;
  for (std::size_t i = 0; i < layers; ++i) {
    result.colour.push_back(make_image(Format::rgba16f, kLayersWidth, kLayersHeight));
    result.depth.push_back(make_image(Format::r32f, kLayersWidth, kLayersHeight));
    for (int y = 0; y < kLayersHeight; ++y) {
      for (int x = 0; x < kLayersWidth; ++x) {
        auto& all = fragments[static_cast<std::size_t>(y * kLayersWidth + x)];
        std::stable_sort(
            all.begin(), all.end(),
            [](const DepthAndColour& a, const DepthAndColour& b) { return a.depth < b.depth; });
        const bool any = i < all.size();
        store_texel(result.colour[i], x, y, any ? all[i].colour : glm::vec4{kLayersClear}, {});
        row<float>(result.depth[i], y)[static_cast<std::size_t>(x)] = any ? all[i].depth : 1.0f;
      }
    }
  }
  return result;
}

void check_equal(const DrawnLayers& a, const DrawnLayers& b) {
  for (std::size_t i = 0; i < a.colour.size(); ++i) {
    INFO("layer ", i);
    CHECK(equal(a.colour[i], b.colour[i]));
    CHECK(equal(a.depth[i], b.depth[i]));
  }
}

}  // namespace

TEST_CASE("layers: the nearest fragments of each pixel, equal depths in the order of submission") {
  for (std::size_t layers = 1; layers <= kMaxLayers; ++layers) {
    CAPTURE(layers);
    const auto triangles = stacked_triangles(24, 100 + layers);
    check_equal(peeled(triangles, layers, HoledColour<false>{}),
                sorted(triangles, layers, HoledColour<false>{}));
  }
}

TEST_CASE("layers: a discarded fragment is in no layer") {
  const auto triangles = stacked_triangles(24, 7);
  check_equal(peeled(triangles, 3, HoledColour<true>{}), sorted(triangles, 3, HoledColour<true>{}));
}

TEST_CASE("layers: the first is what a pass without layers draws") {
  const auto triangles = stacked_triangles(24, 8);
  const DrawnLayers all = peeled(triangles, 4, HoledColour<false>{});
  const DrawnLayers one = peeled(triangles, 1, HoledColour<false>{});
  CHECK(equal(all.colour[0], one.colour[0]));
  CHECK(equal(all.depth[0], one.depth[0]));
}

TEST_CASE("layers: the same for any number of threads") {
  const auto triangles = stacked_triangles(24, 9);
  check_equal(peeled(triangles, 3, HoledColour<false>{}, 3),
              peeled(triangles, 3, HoledColour<false>{}));
}

TEST_CASE("layers: behind the last fragment lies the cleared colour, in all that are left") {
  const DrawnLayers none = peeled({}, 4, HoledColour<false>{});
  for (const Image& layer : none.colour) {
    CHECK(load_texel(layer, 3, 3) == glm::vec4{kLayersClear});
  }
}

TEST_CASE("layers: behind what is not before a depth lies the cleared colour, if so wanted") {
  const auto triangles = stacked_triangles(40, 10);
  const DrawnLayers some = peeled(triangles, 3, HoledColour<false>{}, 1, 0.5f);
  DrawnLayers expected = peeled(triangles, 3, HoledColour<false>{});
  int kept = 0, dropped = 0;
  for (int y = 0; y < kLayersHeight; ++y) {
    for (int x = 0; x < kLayersWidth; ++x) {
      const auto at = static_cast<std::size_t>(x);
      const bool is_kept = row<float>(expected.depth[0], y)[at] < 0.5f;
      ++(is_kept ? kept : dropped);
      for (std::size_t i = 1; i < 3 && !is_kept; ++i) {
        store_texel(expected.colour[i], x, y, glm::vec4{kLayersClear}, {});
        row<float>(expected.depth[i], y)[at] = 1.0f;
      }
    }
  }
  CHECK(kept > 100);
  CHECK(dropped > 100);
  check_equal(some, expected);
}

TEST_CASE("layers: a pass that peels takes no draw that blends, masks, or tests for more") {
  Image colour = make_image(Format::rgba16f, 4, 4), depth = make_image(Format::r32f, 4, 4);
  RenderTargets targets;
  targets.colour[0] = &colour;
  targets.depth = &depth;
  targets.behind[0] = {&colour, &depth};
  CHECK(can_peel(targets, DrawState{}));
  DrawState state;
  state.depth->test = Compare::less_equal;
  CHECK_FALSE(can_peel(targets, state));
  CHECK_FALSE(can_peel(targets, test::adding_state()));
  state = {};
  state.colour[0].write[2] = false;
  CHECK_FALSE(can_peel(targets, state));
  targets.behind[0].depth = nullptr;
  CHECK_FALSE(can_peel(targets, DrawState{}));
}
