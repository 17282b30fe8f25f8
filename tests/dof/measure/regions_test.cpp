#include "dof/measure/regions.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "dof/measure/measures.h"
#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

/// Radius 8 (z - 2) / z: 0 at 2 m, 4 at 4 m, -8 at 1 m.
constexpr PixelCoc kCoc{8.0f, 2.0f};

template <class DepthAt>
Image with_depths(int width, int height, const DepthAt& depth_at) {
  Image image = plain_grey(width, height, 0.5f);
  set_depth(image, depth_at);
  return image;
}

Region label_at(const Image& labels, int x, int y) {
  return static_cast<Region>(row<std::uint8_t>(labels, y)[static_cast<std::size_t>(x)]);
}

bool all(const Image& labels, Region region) {
  for (int y = 0; y < labels.height; ++y) {
    for (int x = 0; x < labels.width; ++x) {
      if (label_at(labels, x, y) != region) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("regions: a plane at one depth is near, in focus or far, to its borders") {
  const auto labels = [](float depth) {
    return label_regions(with_depths(9, 7, [=](int, int) { return depth; }), kCoc);
  };
  CHECK(all(labels(1.0f), Region::near_field));
  CHECK(all(labels(2.0f), Region::focus));
  CHECK(all(labels(4.0f), Region::far_field));
  CHECK(all(labels(std::numeric_limits<float>::infinity()), Region::far_field));
}

TEST_CASE("regions: in focus is a radius of up to one pixel") {
  // 8 (z - 2) / z = 1 at 16 / 7 = 2.286 m, -1 at 16 / 9 = 1.778 m.
  const auto labels = [](float depth) {
    return label_regions(with_depths(3, 3, [=](int, int) { return depth; }), kCoc);
  };
  CHECK(all(labels(2.28f), Region::focus));
  CHECK(all(labels(2.30f), Region::far_field));
  CHECK(all(labels(1.79f), Region::focus));
  CHECK(all(labels(1.76f), Region::near_field));
}

TEST_CASE("regions: an edge in depth has a band as wide as its larger radius on either side") {
  // In focus on the left, radius 4 on the right: the pixels beside the edge are 19 and 20.
  const Image labels =
      label_regions(with_depths(40, 5, [](int x, int) { return x < 20 ? 2.0f : 4.0f; }), kCoc);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 40; ++x) {
      CAPTURE(x);
      const Region right = x == 19 || x == 20 ? Region::edge
                           : x < 15           ? Region::focus
                           : x < 25           ? Region::silhouette
                                              : Region::far_field;
      CHECK(label_at(labels, x, y) == right);
    }
  }
}

TEST_CASE("regions: a wide band ends where its radius does") {
  constexpr PixelCoc kWide{30.0f, 2.0f};  // 15 at 4 m
  const Image labels =
      label_regions(with_depths(40, 3, [](int x, int) { return x < 20 ? 2.0f : 4.0f; }), kWide);
  CHECK(label_at(labels, 3, 1) == Region::focus);
  CHECK(label_at(labels, 4, 1) == Region::silhouette);
  CHECK(label_at(labels, 35, 1) == Region::silhouette);
  CHECK(label_at(labels, 36, 1) == Region::far_field);
}

TEST_CASE("regions: infinity is a depth like any other: its edges have a band") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Image labels =
      label_regions(with_depths(40, 3, [](int x, int) { return x < 20 ? 2.0f : kInfinity; }), kCoc);
  CHECK(label_at(labels, 10, 1) == Region::focus);
  CHECK(label_at(labels, 11, 1) == Region::silhouette);
  CHECK(label_at(labels, 28, 1) == Region::silhouette);
  CHECK(label_at(labels, 29, 1) == Region::far_field);
}

TEST_CASE("regions: the band of a single pixel is a disc around it and its neighbours") {
  // Radius -8 at the pixel; it reaches 8 from itself and from each neighbour across an edge.
  const Image labels = label_regions(
      with_depths(41, 41, [](int x, int y) { return x == 20 && y == 20 ? 1.0f : 2.0f; }), kCoc);
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 41; ++x) {
      bool inside = false;
      for (const auto& [cx, cy] : {std::pair{20, 20}, {19, 20}, {21, 20}, {20, 19}, {20, 21}}) {
        inside = inside || (x - cx) * (x - cx) + (y - cy) * (y - cy) <= 64;
      }
      CHECK(label_at(labels, x, y) == (inside ? Region::silhouette : Region::focus));
    }
  }
}

TEST_CASE("regions: a slope is no edge, nor are two surfaces whose blur is alike") {
  // Radii in steps of 1/2 pixel.
  const Image slope =
      with_depths(16, 4, [](int x, int) { return 16.0f / (8.0f - 0.5f * static_cast<float>(x)); });
  const Image labels = label_regions(slope, kCoc);
  for (int x = 0; x < 16; ++x) CHECK(label_at(labels, x, 2) != Region::silhouette);
  // Radii of 7.84 and 7.92.
  const Image far_away = with_depths(9, 9, [](int x, int) { return x < 4 ? 100.0f : 200.0f; });
  CHECK(all(label_regions(far_away, kCoc), Region::far_field));
}

TEST_CASE("regions: an edge of large circles takes in the whole picture") {
  const Image labels =
      label_regions(with_depths(30, 30, [](int x, int) { return x < 3 ? 0.001f : 2.0f; }), kCoc);
  CHECK(all(labels, Region::silhouette));
}

TEST_CASE("regions: edges are beside outlines of what is in focus, whatever lies behind") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto edges = [](int width, int height, const auto& depth_at) {
    const Image labels = label_regions(with_depths(width, height, depth_at), kCoc);
    int count = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) count += label_at(labels, x, y) == Region::edge ? 1 : 0;
    }
    return count;
  };
  // Both in focus; infinitely far behind; a wire of one pixel; the picture's border on either side.
  CHECK(edges(20, 4, [](int x, int) { return x < 9 ? 1.9f : 2.2f; }) == 2 * 4);
  CHECK(edges(20, 4, [](int, int y) { return y < 2 ? 2.0f : kInfinity; }) == 20 * 2);
  CHECK(edges(20, 4, [](int x, int) { return x == 9 ? 2.0f : 9.0f; }) == 3 * 4);
  CHECK(edges(2, 1, [](int x, int) { return x == 0 ? 2.0f : 9.0f; }) == 2);
  // The nearer one blurred; a step within one surface.
  CHECK(edges(20, 4, [](int x, int) { return x < 9 ? 1.0f : 2.0f; }) == 0);
  CHECK(edges(20, 4, [](int x, int) { return x < 9 ? 2.0f : 2.05f; }) == 0);
  // A slope of 4 % a pixel, and one that ends before another surface.
  const auto slope = [](int x) { return 1.0f / (0.55f - 0.02f * static_cast<float>(x)); };
  CHECK(edges(9, 4, [&](int x, int) { return slope(x); }) == 0);
  CHECK(edges(9, 4, [&](int x, int) { return x < 5 ? slope(x) : 9.0f; }) == 2 * 4);
}

TEST_CASE("regions: a mean by region is that of its pixels, and NaN where there are none") {
  PixelMap map = make_pixel_map(40, 5);
  const Image labels =
      label_regions(with_depths(40, 5, [](int x, int) { return x < 20 ? 2.0f : 4.0f; }), kCoc);
  for (int y = 0; y < 5; ++y) {
    for (std::size_t x = 0; x < 40; ++x) row(map, y)[x] = x < 15 ? 1.0 : x < 25 ? 2.0 : 4.0;
  }
  const auto means = means_by_region(map, labels);
  const auto of = [&](Region region) { return means[static_cast<std::size_t>(region)]; };
  CHECK(of(Region::focus).pixels == 75);
  CHECK(of(Region::focus).mean == 1.0);
  CHECK(of(Region::silhouette).pixels == 40);
  CHECK(of(Region::silhouette).mean == 2.0);
  CHECK(of(Region::edge).pixels == 10);
  CHECK(of(Region::edge).mean == 2.0);
  CHECK(of(Region::far_field).pixels == 75);
  CHECK(of(Region::far_field).mean == 4.0);
  CHECK(of(Region::near_field).pixels == 0);
  CHECK(std::isnan(of(Region::near_field).mean));
}

TEST_CASE("measures: a difference in one region is found in that one alone") {
  ThreadPool pool{1};
  const Image a = with_depths(100, 40, [](int x, int) { return x < 50 ? 2.0f : 4.0f; });
  Image b = a;
  for (int y = 0; y < 40; ++y) store_texel(b, 5, y, {0.75f, 0.75f, 0.75f, 2.0f}, {});
  const Image labels = label_regions(a, kCoc);
  const MeasuredPictures measured = measure_pictures(a, b, &labels, {.hdr_flip = true}, pool);
  const auto of = [&](Region region) {
    return measured.by_region[static_cast<std::size_t>(region)];
  };
  CHECK(of(Region::focus).pixels == 45 * 40);
  CHECK(of(Region::focus).mse == Approx(0.0625 / 45.0).epsilon(1e-9));
  CHECK(of(Region::focus).psnr_db == Approx(-10.0 * std::log10(0.0625 / 45.0)).epsilon(1e-9));
  CHECK(of(Region::focus).toned_mse > 0.0);
  CHECK(of(Region::focus).ssim < 1.0);
  CHECK(of(Region::focus).flip > 0.0);
  CHECK(*of(Region::focus).hdr_flip > 0.0);
  for (const Region region : {Region::silhouette, Region::edge, Region::far_field}) {
    CHECK(of(region).mse == 0.0);
    CHECK(std::isinf(of(region).psnr_db));
    CHECK(of(region).toned_mse == 0.0);
    CHECK(of(region).ssim == 1.0);
    CHECK(of(region).flip == 0.0);
    CHECK(of(region).hdr_flip == 0.0);
  }
  CHECK(of(Region::near_field).pixels == 0);
  CHECK(std::isnan(of(Region::near_field).psnr_db));
}

TEST_CASE("measures: the whole is the regions' means, weighed by their pixels") {
  ThreadPool pool{1};
  const Image a = random_scene_image(60, 50, 1);
  const Image b = random_scene_image(60, 50, 2);
  const Image labels = label_regions(a, kCoc);
  const MeasuredPictures measured = measure_pictures(a, b, &labels, {}, pool);
  CHECK(!measured.whole.hdr_flip);
  CHECK(measured.whole.pixels == 3000);
  double flip = 0.0, ssim = 0.0, mse = 0.0;
  std::uint64_t pixels = 0;
  for (const Measures& region : measured.by_region) {
    if (region.pixels == 0) continue;
    const auto weight = static_cast<double>(region.pixels) / 3000.0;
    pixels += region.pixels;
    flip += weight * region.flip;
    ssim += weight * region.ssim;
    mse += weight * region.mse;
  }
  CHECK(pixels == 3000);
  CHECK(flip == Approx(measured.whole.flip).epsilon(1e-9));
  CHECK(ssim == Approx(measured.whole.ssim).epsilon(1e-9));
  CHECK(mse == Approx(measured.whole.mse).epsilon(1e-9));
  CHECK(measured.whole.flip == Approx(mean(measured.flip)).epsilon(1e-12));
}

TEST_CASE("measures: a picture against itself is perfect") {
  ThreadPool pool{1};
  const Image a = random_scene_image(30, 20, 1);
  const Measures whole = measure_pictures(a, a, nullptr, {.hdr_flip = true}, pool).whole;
  CHECK(whole.mse == 0.0);
  CHECK(std::isinf(whole.psnr_db));
  CHECK(std::isinf(whole.toned_psnr_db));
  CHECK(whole.ssim == 1.0);
  CHECK(whole.flip == 0.0);
  CHECK(whole.hdr_flip == 0.0);
}
