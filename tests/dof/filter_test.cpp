#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "dof/one_pass/one_pass.h"
#include "dof/two_pass/two_pass.h"
#include "dof/weights.h"
#include "raster/images/texel.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

using Filter = void (*)(const DofInput&, const ImageView&, ThreadPool&);

Image filtered(Filter filter, const DofInput& input, ThreadPool& pool) {
  Image result = make_image(Format::rgba16f, input.scene.width, input.scene.height);
  filter(input, result, pool);
  return result;
}

// The equations in binary64, sharing nothing with the program: every sample of a neighbourhood,
// weighed by (10) to (14).
struct Exact {
  double r, g, b, depth;
};
using ExactImage = std::vector<Exact>;

ExactImage to_exact(const Image& image) {
  ExactImage exact;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 t = load_texel(image, x, y);
      exact.push_back({t.x, t.y, t.z, t.w});
    }
  }
  return exact;
}

struct Offset {
  int dx, dy;
};

ExactImage gather_exactly(const ExactImage& source, int width, int height, const DofSettings& s,
                          const std::vector<Offset>& offsets) {
  const auto radius = [&](const Exact& p) {
    const double focus = s.coc.focus_m;
    const double r = std::fabs(s.coc.radius_at_infinity_px * (p.depth - focus) / p.depth);
    return std::min<double>(r, s.max_coc_px);
  };
  const auto light = [](double r) { return 1.0 / std::max(1.0, r * r); };
  ExactImage result(source.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto at = [&](int px, int py) -> const Exact& {
        return source[static_cast<std::size_t>(std::clamp(py, 0, height - 1) * width +
                                               std::clamp(px, 0, width - 1))];
      };
      const Exact& c = at(x, y);
      const double r_c = radius(c);
      double total = light(r_c);
      Exact sum{c.r * total, c.g * total, c.b * total, 0.0};
      for (const Offset& o : offsets) {
        const Exact& p = at(x + o.dx, y + o.dy);
        const double distance = std::sqrt(o.dx * o.dx + o.dy * o.dy);
        const double r_p = radius(p);
        double overlap = 0.0;
        if (r_p >= distance + 1.0) {
          overlap = 1.0;
        } else if (r_p >= distance) {
          overlap = r_p - distance;
        }
        const double leak = p.depth > s.coc.focus_m ? std::min(1.0, s.leak * r_c) : 1.0;
        const double w = overlap * light(r_p) * leak;
        if (w == 0.0) continue;  // what weighs nothing is left out, infinite or not
        sum.r += w * p.r;
        sum.g += w * p.g;
        sum.b += w * p.b;
        total += w;
      }
      result[static_cast<std::size_t>(y * width + x)] = {sum.r / total, sum.g / total,
                                                         sum.b / total, c.depth};
    }
  }
  return result;
}

std::vector<Offset> line_offsets(bool horizontal, int reach) {
  std::vector<Offset> offsets;
  for (int d = -reach; d <= reach; ++d) {
    if (d != 0) offsets.push_back(horizontal ? Offset{d, 0} : Offset{0, d});
  }
  return offsets;
}

std::vector<Offset> square_offsets(int reach) {
  std::vector<Offset> offsets;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (dx != 0 || dy != 0) offsets.push_back({dx, dy});
    }
  }
  return offsets;
}

// Largest difference, relative to the value (at least 2^-10).
double largest_error(const ExactImage& expected, const Image& actual) {
  const ExactImage got = to_exact(actual);
  double worst = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const auto error = [&](double a, double b) {
      worst = std::max(worst, std::fabs(a - b) / std::max(std::fabs(a), 0x1p-10));
    };
    error(expected[i].r, got[i].r);
    error(expected[i].g, got[i].g);
    error(expected[i].b, got[i].b);
  }
  return worst;
}

DofSettings settings(float radius_at_infinity, float max_coc) {
  return {.coc = {radius_at_infinity, 2.0f}, .max_coc_px = max_coc, .leak = 0.25f};
}

const Profile kProfile = Profile{};

}  // namespace

TEST_CASE("the two-pass filter is equations 10 to 14 along x and then along y") {
  ThreadPool pool(1);
  const Image scene = random_scene_image(61, 47, 1);
  for (const float max_coc : {1.0f, 3.5f, 8.0f, 20.0f}) {
    const DofSettings s = settings(15.0f, max_coc);
    const ExactImage across = gather_exactly(to_exact(scene), 61, 47, s, line_offsets(true, 20));
    const ExactImage expected = gather_exactly(across, 61, 47, s, line_offsets(false, 20));
    // Two stores to half, 2^-11 each, and what binary32 adds.
    CHECK(largest_error(expected, filtered(two_pass, {scene, s, kProfile}, pool)) < 2.2 * 0x1p-11);
  }
}

TEST_CASE("the one-pass filter is equations 10 to 14 over a disc") {
  ThreadPool pool(1);
  const Image scene = random_scene_image(41, 37, 2);
  for (const float max_coc : {1.0f, 3.5f, 8.0f, 15.0f}) {
    const DofSettings s = settings(12.0f, max_coc);
    const ExactImage expected = gather_exactly(to_exact(scene), 41, 37, s, square_offsets(15));
    CHECK(largest_error(expected, filtered(one_pass, {scene, s, kProfile}, pool)) < 1.1 * 0x1p-11);
  }
}

TEST_CASE("the filters equal their oracles to the bit") {
  ThreadPool pool(2);
  for (const auto& [filter, oracle] : {std::pair<Filter, Filter>{two_pass, two_pass_oracle},
                                       {two_pass_single, two_pass_single_oracle},
                                       {one_pass, one_pass_oracle}}) {
    for (const NamedProfile& known : profiles()) {
      const Profile& profile = known.profile;
      for (const int size : {1, 2, 33}) {
        if (kHasSanitizers && size == 33 && &known != &profiles().front()) continue;
        const Image scene = random_scene_image(size, 70 - size, 3);
        for (const float max_coc : {0.0f, 0.5f, 1.0f, 7.25f, 40.0f}) {
          const DofSettings s = settings(40.0f, max_coc);
          CHECK(equal(filtered(filter, {scene, s, profile}, pool),
                      filtered(oracle, {scene, s, profile}, pool)));
        }
      }
    }
  }
}

TEST_CASE("the filters give the same bits for any number of threads" *
          doctest::test_suite("threads long")) {
  const Image scene = random_scene_image(203, 101, 4);
  for (const Filter filter : {two_pass, one_pass}) {
    ThreadPool one(1);
    const Image expected = filtered(filter, {scene, settings(9.0f, 12.0f), kProfile}, one);
    for (const int threads : {2, 3, 8}) {
      ThreadPool pool(threads);
      CHECK(equal(filtered(filter, {scene, settings(9.0f, 12.0f), kProfile}, pool), expected));
    }
  }
}

TEST_CASE("a picture in focus passes through the filters unchanged") {
  ThreadPool pool(2);
  Image scene = random_scene_image(64, 64, 5);
  set_depth(scene, [](int, int) { return 2.0f; });
  for (const Filter filter : {two_pass, one_pass}) {
    CHECK(equal(filtered(filter, {scene, settings(30.0f, 16.0f), kProfile}, pool), scene));
  }
}

TEST_CASE("a filter size of zero is the pinhole picture") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(64, 48, 6);
  for (const Filter filter : {two_pass, one_pass}) {
    CHECK(equal(filtered(filter, {scene, settings(30.0f, 0.0f), kProfile}, pool), scene));
  }
}

TEST_CASE("a constant colour stays constant under any blur, borders included") {
  ThreadPool pool(2);
  Image scene = random_scene_image(80, 60, 7);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      const float depth = load_texel(scene, x, y).w;
      store_texel(scene, x, y, {0.5f, 0.25f, 3.0f, depth}, kProfile);
    }
  }
  for (const Filter filter : {two_pass, one_pass}) {
    const Image result = filtered(filter, {scene, settings(20.0f, 24.0f), kProfile}, pool);
    // Sums of rounded weights: half the last bit of a half is the most that remains.
    CHECK(compare_images(result, scene).max_ulp <= 1);
  }
}

TEST_CASE("depth stays in alpha, bit for bit") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(50, 50, 8);
  for (const Filter filter : {two_pass, one_pass}) {
    const Image result = filtered(filter, {scene, settings(20.0f, 16.0f), kProfile}, pool);
    for (int y = 0; y < 50; ++y) {
      for (std::size_t x = 0; x < 50; ++x) {
        CHECK(row<std::uint16_t>(result, y)[4 * x + 3] == row<std::uint16_t>(scene, y)[4 * x + 3]);
      }
    }
  }
}

TEST_CASE("a sharp object in front takes no colour from the background") {
  ThreadPool pool(2);
  Image scene = random_scene_image(64, 64, 9);
  // The left half in focus and black, the right half far and bright.
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool focus = x < 32;
      const float colour = focus ? 0.0f : 10.0f;
      store_texel(scene, x, y, {colour, colour, colour, focus ? 2.0f : 50.0f}, kProfile);
    }
  }
  for (const Filter filter : {two_pass, one_pass}) {
    const Image result = filtered(filter, {scene, settings(12.0f, 16.0f), kProfile}, pool);
    for (int x = 0; x < 32; ++x) CHECK(load_texel(result, x, 30).x == 0.0f);
  }
}

TEST_CASE("a point behind the focus spreads over its circle and no farther") {
  ThreadPool pool(2);
  Image scene = random_scene_image(65, 65, 10);
  for (int y = 0; y < 65; ++y) {
    for (int x = 0; x < 65; ++x) {
      const float light = x == 32 && y == 32 ? 1000.0f : 0.0f;
      store_texel(scene, x, y, {light, light, light, 4.0f}, kProfile);
    }
  }
  // Radius at 4 m, focused at 2 m: half of that at infinity.
  const Image result = filtered(one_pass, {scene, settings(20.0f, 16.0f), kProfile}, pool);
  for (int y = 0; y < 65; ++y) {
    for (int x = 0; x < 65; ++x) {
      const double distance = std::hypot(x - 32, y - 32);
      const float value = load_texel(result, x, y).x;
      if (distance <= 9.0) CHECK(value > 2.0f);
      if (distance >= 10.0) CHECK(value == 0.0f);
    }
  }
}

TEST_CASE("an infinite or NaN pixel harms only what its own circle covers") {
  ThreadPool pool(2);
  const float bad_values[] = {std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN()};
  for (const float bad : bad_values) {
    Image scene = random_scene_image(48, 48, 11);
    // In focus, so its circle is its own pixel; everything around it is blurred.
    set_depth(scene, [](int x, int y) { return x == 20 && y == 20 ? 2.0f : 6.0f; });
    store_texel(scene, 20, 20, {bad, bad, bad, 2.0f}, kProfile);
    for (const Filter filter : {two_pass, one_pass}) {
      const Image result = filtered(filter, {scene, settings(12.0f, 12.0f), kProfile}, pool);
      for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
          const float value = load_texel(result, x, y).x;
          if (x != 20 || y != 20) CHECK(value <= 1.0f);  // false for NaN
        }
      }
    }
  }
}

TEST_CASE("colours past the largest half come out as the largest half") {
  ThreadPool pool(1);
  Image scene = random_scene_image(16, 16, 12);
  set_depth(scene, [](int, int) { return 8.0f; });
  store_texel(scene, 8, 8, {std::numeric_limits<float>::infinity(), 0, 0, 8.0f}, kProfile);
  const Image result = filtered(one_pass, {scene, settings(6.0f, 8.0f), kProfile}, pool);
  CHECK(row<std::uint16_t>(result, 8)[4 * 8] == kHalfLargest);
  CHECK(row<std::uint16_t>(result, 8)[4 * 10] == kHalfLargest);  // its circle reaches 4.5 pixels
  CHECK(row<std::uint16_t>(result, 8)[4 * 13] < kHalfOne);
}

TEST_CASE("zero, infinite and NaN depths are blurred to the largest and nothing breaks") {
  ThreadPool pool(1);
  const DofSettings s = settings(10.0f, 6.0f);
  CHECK(filter_radius(s, 0.0f) == 6.0f);
  CHECK(filter_radius(s, -0.0f) == 6.0f);
  CHECK(filter_radius(s, std::numeric_limits<float>::quiet_NaN()) == 6.0f);
  CHECK(filter_radius(s, std::numeric_limits<float>::infinity()) == 6.0f);
  Image scene = random_scene_image(32, 32, 13);
  const float depths[] = {0.0f, std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN(), 3.0f};
  set_depth(scene, [&](int x, int y) { return depths[(x + y) % 4]; });
  for (const Filter filter : {two_pass, one_pass}) {
    const Image result = filtered(filter, {scene, s, kProfile}, pool);
    for (int x = 0; x < 32; ++x) CHECK(load_texel(result, x, 16).x <= 1.0f);
  }
}

TEST_CASE("each texel of the disc is a ring's sample exactly once, nearest rings first") {
  const std::vector<RingTap> taps = ring_taps(9.0f);
  int inside = 0;
  for (int dy = -9; dy <= 9; ++dy) {
    for (int dx = -9; dx <= 9; ++dx) {
      const bool in_disc = dx * dx + dy * dy < 81 && (dx != 0 || dy != 0);
      const auto found = std::count_if(taps.begin(), taps.end(),
                                       [&](const RingTap& t) { return t.dx == dx && t.dy == dy; });
      CHECK(found == (in_disc ? 1 : 0));
      inside += in_disc ? 1 : 0;
    }
  }
  CHECK(static_cast<int>(taps.size()) == inside);
  for (std::size_t i = 1; i < taps.size(); ++i) {
    CHECK(std::lround(taps[i].distance_px) >= std::lround(taps[i - 1].distance_px));
  }
}

TEST_CASE("the taps end just short of the radius, where the overlap ends") {
  CHECK(tap_count(0.0f) == 0);
  CHECK(tap_count(1.0f) == 0);
  CHECK(tap_count(1.5f) == 1);
  CHECK(tap_count(16.0f) == 15);
  CHECK(overlap(16.0f, 16.0f) == 0.0f);
  CHECK(overlap(16.0f, 15.0f) == 1.0f);
  CHECK(overlap(7.5f, 7.0f) == 0.5f);
}
