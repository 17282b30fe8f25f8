#include "dof/half_resolution/half_fields.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dof/half_resolution/fill_holes.h"
#include "raster/images/texel.h"
#include "tests/dof/half_resolution/merge_oracle.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// The header's equations for the green of four pixels.
struct Cell {
  double far = 0.0, far_radius = 0.0, weights = 0.0, seen = 0.0;
  double near = 0.0, near_radius = 0.0, opacity = 0.0;
};
Cell cell_of(const std::array<SplitTexel, 4>& four) {
  Cell cell;
  for (const SplitTexel& texel : four) {
    const auto r = static_cast<double>(texel.radius_px);
    const double shown = test::half_share_of(r);
    const double near = r < 0.0 ? shown : 0.0, left = 1.0 - near;
    const double weight = left * std::max(r < 0.0 ? 0.0 : shown, 0x1p-20);
    cell.far += weight * static_cast<double>(texel.g);
    cell.far_radius += weight * std::max(r, 0.0);
    cell.weights += weight;
    cell.seen += left;
    cell.near += near * static_cast<double>(texel.g);
    cell.near_radius += near * std::max(-r, 0.0);
    cell.opacity += near;
  }
  return cell;
}
double size_of(double radius) {
  return std::max(0.5, 0.5 * std::sqrt(std::max(radius * radius - 4.0, 0.0)));
}

}  // namespace

TEST_CASE("the cells of half resolution are what their equations say") {
  ThreadPool pool(2);
  constexpr int kWidth = 41, kHeight = 26;
  const Image scene = random_scene_image(kWidth, kHeight, 1);
  const DofInput input{scene, {.coc = {14.0f, 2.0f}, .max_coc_px = 9.0f}, {}};
  const HalfFields fields = make_half_fields(input, pool);
  CHECK(fields.near_field);
  double worst = 0.0;
  for (int y = 0; y < (kHeight + 1) / 2; ++y) {
    for (int x = 0; x < (kWidth + 1) / 2; ++x) {
      std::array<SplitTexel, 4> four;
      for (int i = 0; i < 4; ++i) {
        four[static_cast<std::size_t>(i)] = split_texel(input, std::min(2 * x + i % 2, kWidth - 1),
                                                        std::min(2 * y + i / 2, kHeight - 1));
      }
      const Cell cell = cell_of(four);
      const auto differs = [&](int plane, double expected) {
        worst = std::max(worst, std::fabs(test::cell_value(fields, plane, x, y) - expected));
      };
      differs(kNearColour + 1, 0.25 * cell.near);
      differs(kNearOpacity, 0.25 * cell.opacity);
      if (cell.opacity >= 1.0) differs(kNearSize, size_of(cell.near_radius / cell.opacity));
      if (cell.seen < 1.0) continue;  // filled
      differs(kFarColour + 1, cell.far / cell.weights);
      differs(kFarSize, size_of(cell.far_radius / cell.weights));
      differs(kFarWeight, cell.weights / cell.seen);
    }
  }
  CHECK(worst < 1e-5);
}

TEST_CASE("holes are filled from around them, and cells that are there stay") {
  ThreadPool pool(2);
  constexpr int kWidth = 37, kHeight = 21;
  Planes planes = make_planes(3, kWidth, kHeight, pool);
  const auto hole = [](int x, int y) { return x >= 10 && x < 23 && y >= 6 && y < 15; };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      plane_row(planes, 0, y)[x] = hole(x, y) ? 1000.0f : static_cast<float>(x);
      plane_row(planes, 1, y)[x] = hole(x, y) ? -1.0f : 0.375f;
      plane_row(planes, 2, y)[x] = hole(x, y) ? 0.0f : 1.0f;
    }
  }
  const int channels[] = {0, 1};
  fill_holes(planes, channels, 2, pool);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float value = plane_row(planes, 0, y)[x], constant = plane_row(planes, 1, y)[x];
      if (!hole(x, y)) {
        CHECK(value == static_cast<float>(x));
        CHECK(constant == 0.375f);
        continue;
      }
      // A ramp goes on through the hole, roughly.
      CHECK(std::fabs(value - static_cast<float>(x)) < 5.0f);
      CHECK(std::fabs(constant - 0.375f) < 1e-5f);
    }
  }
}

TEST_CASE("planes with nothing but holes keep the mean of their values") {
  ThreadPool pool(1);
  Planes planes = make_planes(2, 5, 3, pool);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      plane_row(planes, 0, y)[x] = 2.5f;
      plane_row(planes, 1, y)[x] = 0.0f;
    }
  }
  const int channels[] = {0};
  fill_holes(planes, channels, 1, pool);
  for (int x = 0; x < 5; ++x) CHECK(std::fabs(plane_row(planes, 0, 1)[x] - 2.5f) < 1e-5f);
}

namespace {

// A bright pixel in the middle of a grey picture of one depth.
Image lamp(float depth_m, float light) {
  Image image = make_image(Format::rgba16f, 65, 65);
  for (int y = 0; y < 65; ++y) {
    for (int x = 0; x < 65; ++x) {
      const float value = x == 32 && y == 32 ? light : 0.25f;
      store_texel(image, x, y, {value, value, value, depth_m}, {});
    }
  }
  return image;
}
HalfFields fields_of(const Image& scene, ThreadPool& pool) {
  return make_half_fields({scene, {.coc = {20.0f, 2.0f}, .max_coc_px = 16.0f}, {}}, pool);
}
std::size_t count_of(const Highlights& highlights) {
  std::size_t count = 0;
  for (const std::vector<Highlight>& row : highlights.rows) count += row.size();
  return count;
}

}  // namespace

TEST_CASE("a highlight is a pixel out of focus, twice as bright as what is around it") {
  ThreadPool pool(2);
  for (const float depth_m : {4.0f, 4.0f / 3.0f}) {
    CHECK(count_of(fields_of(lamp(depth_m, 0.45f), pool).highlights) == 0);
    const HalfFields fields = fields_of(lamp(depth_m, 50.0f), pool);
    REQUIRE(count_of(fields.highlights) == 1);
    const Highlight light = fields.highlights.rows[32].front();
    CHECK(light.x == 32);
    CHECK(light.excess[1] == 49.5f);
    // The rest stays in its cell.
    const int plane = depth_m > 2.0f ? kFarColour : kNearColour;
    CHECK(std::fabs(test::cell_value(fields, plane, 16, 16) - 0.3125) < 1e-5);
  }
  CHECK(count_of(fields_of(lamp(2.0f, 50.0f), pool).highlights) == 0);
}

TEST_CASE("a highlight's disc is even and holds its light") {
  ThreadPool pool(2);
  const HalfFields fields = fields_of(lamp(4.0f, 50.0f), pool);  // of radius 10
  HighlightScratch scratch;
  std::vector<float> sums(3 * kHighlightLayers * 65);
  double light = 0.0;
  const int layer = highlight_layer(10.0f);
  for (int y = 0; y < 65; ++y) {
    const std::uint32_t used = highlight_row(fields.highlights, y, 65, scratch, sums.data(), 65);
    CHECK((used == 0) == (std::abs(y - 32) > fields.highlights.reach));
    if (used == 0) continue;
    CHECK(used == 1u << layer);
    for (int x = 0; x < 65; ++x) {
      const float value = sums[static_cast<std::size_t>(3 * layer * 65 + x)];
      light += static_cast<double>(value);
      const double distance = std::hypot(x - 32, y - 32);
      if (distance > 11.0) CHECK(value == 0.0f);
      if (distance < 9.0) CHECK(std::fabs(value / 49.5f * 314.159f - 1.0f) < 0.02f);
    }
  }
  CHECK(std::fabs(light / 49.5 - 1.0) < 1e-6);
}

TEST_CASE("a sharp thing hides a highlight's disc, and something a little less blurred does not") {
  const int layer = highlight_layer(20.0f);
  CHECK(highlight_visible(layer, 0.0f) == 0.0f);
  CHECK(highlight_visible(layer, 3.0f) == 0.0f);
  CHECK(highlight_visible(layer, 10.0f) == 1.0f);
  CHECK(highlight_visible(layer, 60.0f) == 1.0f);
  CHECK(highlight_visible(layer, -9.0f) == 1.0f);
  CHECK(highlight_visible(kHighlightNear, 0.0f) == 1.0f);
}

TEST_CASE("the fields have the same bits for any number of threads and on every vector unit") {
  const Image scene = random_scene_image(131, 77, 3);
  const DofInput input{scene, {.coc = {14.0f, 2.0f}, .max_coc_px = 12.0f}, {}};
  ThreadPool one(1, Isa::scalar);
  const HalfFields expected = make_half_fields(input, one);
  for (const Isa isa : available_isas()) {
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads, isa);
      const HalfFields fields = make_half_fields(input, pool);
      int wrong = 0;
      for (int plane = 0; plane < kHalfPlanes; ++plane) {
        for (int y = 0; y < fields.cells.height; ++y) {
          const float* a = plane_row(fields.cells, plane, y);
          const float* b = plane_row(expected.cells, plane, y);
          for (int x = 0; x < fields.cells.width; ++x) wrong += a[x] != b[x];
        }
      }
      INFO(std::string{isa_name(isa)}, ", ", threads, " threads");
      CHECK(wrong == 0);
    }
  }
}
