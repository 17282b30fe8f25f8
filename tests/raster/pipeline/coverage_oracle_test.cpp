// Coverage against an oracle that needs no rule for edges.

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/setup.h"
#include "tests/support/coverage_counts.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;
using test::profile_named;

namespace {

#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 Wide;
#else
using Wide = std::int64_t;  // enough for positions below 2^20 pixels
#endif

struct Snapped {
  Wide x, y;  // 1/256 pixel from the centre of pixel (0, 0)
};

Wide snap_in_double(float window) {
  const double steps = static_cast<double>(window - 0.5f) * 256.0;
  double whole = std::floor(steps);
  const double rest = steps - whole;
  if (rest > 0.5 || (rest == 0.5 && std::fmod(whole, 2.0) != 0.0)) whole += 1.0;
  return static_cast<Wide>(whole);
}

int sign(Wide value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// The side of line a b on which a point lies that is a hair right of pixel (x, y)'s centre
// and a far smaller hair below it. That point is on no line, so "inside" needs no rule for
// edges: a centre on a left edge moves in, one on a right edge out, and one on a level
// edge in if the triangle is below.
int side(const Snapped& a, const Snapped& b, int x, int y) {
  const Wide dx = b.x - a.x;
  const Wide dy = b.y - a.y;
  const Wide at_centre =
      dx * (static_cast<Wide>(y) * 256 - a.y) - dy * (static_cast<Wide>(x) * 256 - a.x);
  if (at_centre != 0) return sign(at_centre);
  return dy != 0 ? sign(-dy) : sign(dx);
}

bool covers(const std::array<Snapped, 3>& t, int x, int y) {
  const int first = side(t[0], t[1], x, y);
  return first != 0 && first == side(t[1], t[2], x, y) && first == side(t[2], t[0], x, y);
}

bool has_area(const std::array<Snapped, 3>& t) {
  return (t[1].x - t[0].x) * (t[2].y - t[0].y) != (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

// Draws triangles one by one into sums of 1, number and square, and compares with the
// oracle: a wrong pixel of one triangle cannot hide behind another's.
int wrong_against_oracle(const std::vector<glm::vec4>& positions, int width, int height,
                         const Profile& profile = {}) {
  std::vector<VertexOutput<4>> vertices;
  Image expected = make_image(Format::rgba32f, width, height);
  for (std::size_t t = 0; t < positions.size() / 3; ++t) {
    const auto number = static_cast<float>(t % 101 + 1);
    std::array<Snapped, 3> snapped{};
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::vec4& position = positions[3 * t + i];
      vertices.push_back({position, {1.0f, number, number * number, 0.0f}});
      const WindowVertex window = to_window(position, width, height, profile.viewport);
      snapped[i] = {snap_in_double(window.x), snap_in_double(window.y)};
    }
    if (!has_area(snapped)) continue;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!covers(snapped, x, y)) continue;
        auto* sum = &row<float>(expected, y)[static_cast<std::size_t>(4 * x)];
        sum[0] += 1.0f;
        sum[1] += number;
        sum[2] += number * number;
      }
    }
  }
  Image drawn = make_image(Format::rgba32f, width, height);
  test::draw_list({.colour = {&drawn}}, test::adding_state(), vertices,
                  test::VaryingColour<Interpolation::flat>{}, profile);
  int wrong = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) wrong += load_texel(drawn, x, y) != load_texel(expected, x, y);
  }
  return wrong;
}

glm::vec4 some_position(test::Random& random, int width, int height, float margin) {
  const float x = random.between(-margin, static_cast<float>(width) + margin);
  const float y = random.between(-margin, static_cast<float>(height) + margin);
  return test::at_window({x, y}, width, height) * random.between(0.5f, 2.0f);
}

}  // namespace

TEST_CASE("random triangles cover what an oracle without an edge rule says, at many target sizes") {
  test::Random random{76};
  int wrong = 0;
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {64, 64}, {65, 63}, {100, 130}}) {
    for (const float margin : {0.0f, 30.0f, 400.0f}) {
      std::vector<glm::vec4> positions;
      positions.reserve(3 * 150);
      for (int i = 0; i < 3 * 150; ++i) {
        positions.push_back(
            some_position(random, width, height,
                          std::min(margin, 6.0f * static_cast<float>(std::min(width, height)))));
      }
      wrong += wrong_against_oracle(positions, width, height);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE(
    "random triangles with vertices on pixel centres and corners cover what the oracle says") {
  test::Random random{77};
  std::vector<glm::vec4> positions;
  for (int i = 0; i < 3 * fewer(3'000); ++i) {
    const glm::vec2 window{static_cast<float>(random.whole(-8, 72)) * 0.5f,
                           static_cast<float>(random.whole(-8, 72)) * 0.5f};
    positions.push_back(test::at_window(window, 32, 32));
  }
  CHECK(wrong_against_oracle(positions, 32, 32) == 0);
  // Fused, but not clipped at the window's edge: the oracle does not clip.
  Profile fused = profile_named("llvmpipe");
  fused.guard_band = 16.0f;
  CHECK(wrong_against_oracle(positions, 32, 32, fused) == 0);
}

TEST_CASE("small triangles and slivers cover what the oracle says") {
  test::Random random{78};
  std::vector<glm::vec4> positions;
  for (int i = 0; i < fewer(4'000); ++i) {
    const glm::vec2 a{random.between(0.0f, 32.0f), random.between(0.0f, 32.0f)};
    const glm::vec2 step{random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f)};
    const glm::vec2 along = i % 2 == 0 ? step : step * 15.0f;
    const float width = i % 2 == 0 ? 1.0f : 1.0f / 64.0f;
    const glm::vec2 across{random.between(-width, width), random.between(-width, width)};
    for (const glm::vec2 p : {a, a + along, a + along * 0.5f + across}) {
      positions.push_back(test::at_window(p, 32, 32));
    }
  }
  CHECK(wrong_against_oracle(positions, 32, 32) == 0);
}

TEST_CASE("triangles as large as the guard band cover what the oracle says") {
  test::Random random{79};
  std::vector<glm::vec4> positions;
  positions.reserve(3 * 1'500);
  for (int i = 0; i < 3 * fewer(1'500); ++i) {
    positions.push_back({random.between(-15.9f, 15.9f), random.between(-15.9f, 15.9f), 0.0f, 1.0f});
  }
  CHECK(wrong_against_oracle(positions, 64, 64) == 0);
}
