#include "dof/scatter/layers.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "dof/scatter/layer_planes.h"
#include "dof/scatter/scatter_discs.h"
#include "raster/images/texel.h"
#include "tests/support/method_checks.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

Image filtered(const Image& scene, const DofSettings& settings, ThreadPool& pool) {
  Image result = make_image(Format::rgba16f, scene.width, scene.height);
  layers({scene, settings, {}}, result, pool);
  return result;
}

struct Size {
  int width, height;
};

// The equations of layer_planes.h for one plane, level by level.
struct Level {
  int width, height;
  std::vector<float> value, known;

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width +
                                    std::clamp(x, 0, width - 1));
  }
};

// The places 0, 1, 2, ... along an axis, the middle one of an odd number twice.
std::vector<int> places(int size) {
  std::vector<int> all;
  for (int i = 0; i < size; ++i) {
    all.push_back(i);
    if (size % 2 == 1 && i == size / 2) all.push_back(i);
  }
  return all;
}

// The shares of the coarser level's pixels in a pixel.
std::vector<std::pair<int, float>> shares(int fine, int size) {
  const std::vector<int> all = places(size);
  const auto first = static_cast<int>(std::find(all.begin(), all.end(), fine) - all.begin());
  const bool twice = std::count(all.begin(), all.end(), fine) == 2;
  if (twice && first % 2 == 1) return {{first / 2, 0.5f}, {first / 2 + 1, 0.5f}};
  const int beside = twice ? first / 2 : first / 2 + (first % 2 == 0 ? -1 : 1);
  return {{first / 2, 0.75f}, {beside, 0.25f}};
}

void guess_oracle(Level& level) {
  if (std::find(level.known.begin(), level.known.end(), 0.0f) == level.known.end()) return;
  if (level.width == 1 && level.height == 1) return;
  Level coarse{(level.width + 1) / 2, (level.height + 1) / 2, {}, {}};
  const std::vector<int> across = places(level.width), down = places(level.height);
  for (std::size_t y = 0; y < down.size(); y += 2) {
    for (std::size_t x = 0; x < across.size(); x += 2) {
      float sum = 0.0f, count = 0.0f;
      for (const int row : {down[y], down[y + 1]}) {
        const std::size_t left = level.at(across[x], row), right = level.at(across[x + 1], row);
        sum += (level.known[left] != 0.0f ? level.value[left] : 0.0f) +
               (level.known[right] != 0.0f ? level.value[right] : 0.0f);
        count += level.known[left] + level.known[right];
      }
      coarse.value.push_back(count > 0.0f ? sum / count : 0.0f);
      coarse.known.push_back(count > 0.0f ? 1.0f : 0.0f);
    }
  }
  guess_oracle(coarse);
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      if (level.known[level.at(x, y)] != 0.0f) continue;
      float value = 0.0f;
      for (const auto& [row, share] : shares(y, level.height)) {
        float of_row = 0.0f;
        for (const auto& [column, part] : shares(x, level.width)) {
          of_row += part * coarse.value[coarse.at(column, row)];
        }
        value += share * of_row;
      }
      level.value[level.at(x, y)] = value;
    }
  }
}

}  // namespace

TEST_CASE("layers give their oracle's bits") {
  for (const Isa isa : available_isas()) {
    for (const int threads : {1, 3}) {
      ThreadPool pool(threads, isa);
      for (const int size : {1, 2, 37, 64}) {
        const Image scene = random_scene_image(size, 66 - size, 1);
        for (const float max_coc : {0.0f, 0.7f, 2.0f, 9.4f, 100.0f}) {
          const DofSettings settings{.coc = {30.0f, 2.0f}, .max_coc_px = max_coc};
          Image expected = make_image(Format::rgba16f, scene.width, scene.height);
          layers_oracle({scene, settings, {}}, expected, pool);
          INFO(std::string{isa_name(isa)}, ", size ", size, ", max_coc ", max_coc);
          CHECK(equal(filtered(scene, settings, pool), expected));
        }
      }
    }
  }
}

TEST_CASE("what layers leave out far from any edge changes no bit") {
  ThreadPool pool(2);
  // A near square on a middle one on a far wall, tiles deep inside each.
  const Image random = random_scene_image(160, 130, 2);
  Image scene = random;
  set_depth(scene, [](int x, int y) {
    return x > 70 && y > 60 ? 1.2f : x > 20 && y > 20 ? 2.0f : 9.0f;
  });
  const DofSettings settings{.coc = {11.0f, 2.0f}, .max_coc_px = 16.0f};
  Image expected = make_image(Format::rgba16f, 160, 130);
  layers_oracle({scene, settings, {}}, expected, pool);
  CHECK(equal(filtered(scene, settings, pool), expected));
}

TEST_CASE("a guess of hidden pixels is what its equations say, to the bit") {
  ThreadPool pool(3);
  for (const Size size : {Size{1, 1}, {2, 1}, {7, 5}, {64, 33}, {3, 90}}) {
    const int width = size.width, height = size.height;
    for (const int every : {2, 17, 1000}) {
      Planes sheet = make_planes(2, width, height, pool);
      Level level{width, height, {}, {}};
      const Image noise = random_scene_image(width, height, 3);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const bool known = (x * 7 + y * 13) % every == 0;
          level.value.push_back(load_texel(noise, x, y).x);
          level.known.push_back(known ? 1.0f : 0.0f);
          plane_row(sheet, 0, y)[x] = level.value.back();
          plane_row(sheet, 1, y)[x] = level.known.back();
        }
      }
      guess_hidden(sheet, 1, pool);
      guess_oracle(level);
      int wrong = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          wrong +=
              plane_row(sheet, 0, y)[x] != level.value[static_cast<std::size_t>(y * width + x)];
        }
      }
      INFO(width, "x", height, ", one known of ", every);
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE(
    "a hole within one value takes that value, and a sheet without any value stays as it is") {
  ThreadPool pool(2);
  Planes sheet = make_planes(2, 50, 40, pool);
  for (const bool hole : {true, false}) {
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 50; ++x) {
        plane_row(sheet, 0, y)[x] = 0.625f;
        plane_row(sheet, 1, y)[x] = hole && (x < 5 || y > 35) ? 1.0f : 0.0f;
      }
    }
    guess_hidden(sheet, 1, pool);
    for (int x = 0; x < 50; ++x) CHECK(plane_row(sheet, 0, 10)[x] == 0.625f);
  }
}

TEST_CASE("depth is cut where things fall apart, and a slope is not cut") {
  ThreadPool pool(1);
  Planes scene = make_planes(4, 60, 1, pool);
  float* radius = plane_row(scene, 3, 0);
  const auto fill = [&](int begin, int end, float radius_px) {
    std::fill(radius + begin, radius + end, radius_px);
  };
  fill(0, 10, -12.0f);
  fill(10, 20, -3.0f);
  fill(20, 40, 0.0f);
  fill(40, 60, 9.0f);
  const LayerSplit split = split_layers(scene);
  CHECK(split.near_px < -3.0f);
  CHECK(split.near_px > -12.0f);
  CHECK(split.far_px > 0.0f);
  CHECK(split.far_px < 9.0f);
  for (const float slope : {0.0f, 0.4f}) {
    for (int x = 0; x < 60; ++x) radius[x] = slope * static_cast<float>(x - 30);
    CHECK(split_layers(scene).near_px < radius[0]);
    CHECK(split_layers(scene).far_px > radius[59]);
  }
}

TEST_CASE("tiles that discs can touch are all those within their reach") {
  ThreadPool pool(2);
  for (const int reach_px : {-1, 0, 15, 16, 40}) {
    const TileReach reach = tile_reach(
        200, 100, pool, [&](int x, int y) { return x == 100 && y == 50 ? reach_px : -1; });
    const TileMask mask = touched(reach);
    int missing = 0, beyond = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 200; ++x) {
        const int apart = std::max(std::abs(x - 100), std::abs(y - 50));
        // A span may reach a pixel farther than its disc's rows.
        missing += reach_px >= 0 && apart <= reach_px + 1 && !is_set(mask, x, y);
        beyond += (reach_px < 0 || apart > reach_px + 3 * kReachTile) && is_set(mask, x, y);
      }
    }
    CHECK(missing == 0);
    CHECK(beyond == 0);
    const TileMask self = touching(reach, mask);
    CHECK((is_set(self, 100, 50)) == (reach_px >= 0));
    CHECK_FALSE(is_set(self, 0, 0));
  }
}

TEST_CASE("a blurred edge of a near layer is soft on both sides, over a background filled in") {
  test::check_soft_near_edge(
      [](const DofInput& input, Image& result, ThreadPool& pool) { layers(input, result, pool); },
      0.02);
}

TEST_CASE("a near slope lets nothing through, nor does a near thing at the border") {
  ThreadPool pool(2);
  // White from radius -20 at the left to -2 before a black wall in focus at the right.
  const Image scene = grey_depth_picture(160, 40, [](int x, int) {
    return x < 120 ? std::pair{1.0f, 2.0f / (2.0f - 0.0075f * static_cast<float>(x))}
                   : std::pair{0.0f, 2.0f};
  });
  const DofSettings settings{.coc = {20.0f, 2.0f}, .max_coc_px = 32.0f};
  const Image result = filtered(scene, settings, pool);
  for (int x = 0; x < 60; ++x) CHECK(load_texel(result, x, 20).x == 1.0f);
}

TEST_CASE("a thin near bar lets what is around it shine through") {
  ThreadPool pool(2);
  // A black bar 5 pixels wide at radius 10: a lens sees at most a third of it at any place.
  const Image scene = grey_depth_picture(96, 64, [](int x, int) {
    return x >= 46 && x < 51 ? std::pair{0.0f, 1.0f} : std::pair{1.0f, 2.0f};
  });
  const DofSettings settings{.coc = {10.0f, 2.0f}, .max_coc_px = 16.0f};
  const Image result = filtered(scene, settings, pool);
  // 5 / (10 pi / 2) of a disc's light, by its middle.
  CHECK(load_texel(result, 48, 32).x == doctest::Approx(1.0 - 0.315).epsilon(0.02));
}
