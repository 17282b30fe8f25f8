// Coverage by spans between floating-point edges.

#include "raster/pipeline/setup.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

using Corners = std::array<WindowVertex, 3>;

WindowVertex vertex(float x, float y) { return {x, y, 0.5f, 1.0f}; }

Corners some_triangle(test::Random& random) {
  Corners corners{};
  for (WindowVertex& corner : corners) {
    const float x = random.between(0.0f, 64.0f);
    corner = vertex(x, random.between(0.0f, 64.0f));
  }
  return corners;
}

// The spans of all rows that have one, by row.
std::map<int, std::pair<int, int>> spans_of(const Corners& corners) {
  std::map<int, std::pair<int, int>> spans;
  const auto scanlines = make_scanlines(corners);
  for (int y = 0; scanlines && y < 64; ++y) {
    const Span span = covered_span(*scanlines, y, 0, 64);
    if (span.x_begin < span.x_end) spans[y] = {span.x_begin, span.x_end};
  }
  return spans;
}

std::array<std::size_t, 3> order_of(float y0, float y1, float y2) {
  return from_top_to_bottom({vertex(0, y0), vertex(1, y1), vertex(2, y2)});
}

// Distance in pixels from a pixel's centre to the inside of edge a b, negative outside.
double depth_inside(const WindowVertex& a, const WindowVertex& b, int x, int y, bool clockwise) {
  const double dx = static_cast<double>(b.x) - a.x;
  const double dy = static_cast<double>(b.y) - a.y;
  const double cross = dx * (y + 0.5 - a.y) - dy * (x + 0.5 - a.x);
  return (clockwise ? cross : -cross) / std::hypot(dx, dy);
}

}  // namespace

TEST_CASE("the spans of a right-angled triangle end on its long edge, whose centres they own") {
  const auto spans = spans_of({vertex(1, 1), vertex(1, 9), vertex(9, 1)});
  const std::map<int, std::pair<int, int>> expected{{1, {1, 9}}, {2, {1, 8}}, {3, {1, 7}},
                                                    {4, {1, 6}}, {5, {1, 5}}, {6, {1, 4}},
                                                    {7, {1, 3}}, {8, {1, 2}}};
  CHECK(spans == expected);
}

TEST_CASE("the spans of a triangle with its middle vertex on the left or on the right") {
  // Rows grow by two pixels down to y = 4 and shrink by two after it.
  const std::map<int, std::pair<int, int>> on_right{{0, {8, 9}},  {1, {8, 11}}, {2, {8, 13}},
                                                    {3, {8, 15}}, {4, {8, 15}}, {5, {8, 13}},
                                                    {6, {8, 11}}, {7, {8, 9}}};
  CHECK(spans_of({vertex(8, 0), vertex(16, 4), vertex(8, 8)}) == on_right);
  CHECK(spans_of({vertex(8, 8), vertex(16, 4), vertex(8, 0)}) == on_right);
  const std::map<int, std::pair<int, int>> on_left{{0, {7, 8}}, {1, {5, 8}}, {2, {3, 8}},
                                                   {3, {1, 8}}, {4, {1, 8}}, {5, {3, 8}},
                                                   {6, {5, 8}}, {7, {7, 8}}};
  CHECK(spans_of({vertex(8, 0), vertex(0, 4), vertex(8, 8)}) == on_left);
}

TEST_CASE("spans own the centres on upper and right edges, not those on lower and left ones") {
  const auto spans = spans_of({vertex(2.5f, 3.5f), vertex(2.5f, 8.5f), vertex(6.5f, 3.5f)});
  CHECK(spans.begin()->first == 3);
  CHECK(spans.begin()->second == std::pair{3, 7});
  const auto turned = spans_of({vertex(6.5f, 8.5f), vertex(6.5f, 3.5f), vertex(2.5f, 8.5f)});
  CHECK(turned.rbegin()->first == 7);
  CHECK(turned.rbegin()->second.second == 7);
}

TEST_CASE("vertices are sorted from top to bottom, equal ones as the driver does") {
  CHECK(order_of(1, 2, 3) == std::array<std::size_t, 3>{0, 1, 2});
  CHECK(order_of(1, 3, 2) == std::array<std::size_t, 3>{0, 2, 1});
  CHECK(order_of(2, 1, 3) == std::array<std::size_t, 3>{1, 0, 2});
  CHECK(order_of(3, 1, 2) == std::array<std::size_t, 3>{1, 2, 0});
  CHECK(order_of(2, 3, 1) == std::array<std::size_t, 3>{2, 0, 1});
  CHECK(order_of(3, 2, 1) == std::array<std::size_t, 3>{2, 1, 0});
  CHECK(order_of(1, 1, 2) == std::array<std::size_t, 3>{0, 1, 2});
  CHECK(order_of(2, 2, 1) == std::array<std::size_t, 3>{2, 0, 1});
  CHECK(order_of(1, 2, 2) == std::array<std::size_t, 3>{0, 1, 2});
  CHECK(order_of(2, 1, 1) == std::array<std::size_t, 3>{2, 1, 0});
  CHECK(order_of(1, 2, 1) == std::array<std::size_t, 3>{2, 0, 1});
  CHECK(order_of(2, 1, 2) == std::array<std::size_t, 3>{1, 0, 2});
}

TEST_CASE("pixels whose centres are clear of the edges are covered if they are inside") {
  test::Random random{101};
  int wrong = 0;
  int inside_count = 0;
  for (int i = 0; i < 2'000; ++i) {
    const Corners c = some_triangle(random);
    const auto scanlines = make_scanlines(c);
    REQUIRE(scanlines);
    for (int y = 0; y < 64; ++y) {
      const Span span = covered_span(*scanlines, y, 0, 64);
      for (int x = 0; x < 64; ++x) {
        double depth = 100.0;
        for (std::size_t k = 0; k < 3; ++k) {
          depth = std::min(depth, depth_inside(c[k], c[(k + 1) % 3], x, y, scanlines->clockwise));
        }
        if (std::fabs(depth) < 1e-4) continue;
        inside_count += depth > 0.0;
        wrong += (x >= span.x_begin && x < span.x_end) != (depth > 0.0);
      }
    }
  }
  CHECK(wrong == 0);
  CHECK(inside_count > 500'000);
}

TEST_CASE("a span asked for in parts is the same span") {
  test::Random random{102};
  int wrong = 0;
  for (int i = 0; i < 2'000; ++i) {
    const auto scanlines = make_scanlines(some_triangle(random));
    REQUIRE(scanlines);
    const int middle = random.whole(1, 63);
    for (int y = 0; y < 64; ++y) {
      const Span all = covered_span(*scanlines, y, 0, 64);
      const Span left = covered_span(*scanlines, y, 0, middle);
      const Span right = covered_span(*scanlines, y, middle, 64);
      for (int x = 0; x < 64; ++x) {
        const Span& part = x < middle ? left : right;
        wrong += (x >= all.x_begin && x < all.x_end) != (x >= part.x_begin && x < part.x_end);
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("all spans lie within the bounds, slivers and level edges included") {
  test::Random random{103};
  int wrong = 0;
  for (int i = 0; i < 20'000; ++i) {
    Corners c = some_triangle(random);
    if (i % 2 == 0) c[1].y = c[0].y + random.between(-0.001f, 0.001f);
    if (i % 3 == 0) c[2].x = (c[0].x + c[1].x) * 0.5f + random.between(-0.1f, 0.1f);
    const auto scanlines = make_scanlines(c);
    if (!scanlines) continue;
    const Rectangle& bounds = scanlines->bounds;
    for (int y = -2; y < 67; ++y) {
      const Span span = covered_span(*scanlines, y, 0, 80);
      if (span.x_begin >= span.x_end) continue;
      wrong += y < bounds.y_begin || y >= bounds.y_end || span.x_begin < bounds.x_begin ||
               span.x_end > bounds.x_end;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a triangle without area has no spans") {
  CHECK_FALSE(make_scanlines({vertex(8, 8), vertex(8, 8), vertex(40, 20)}));
  CHECK_FALSE(make_scanlines({vertex(8, 8), vertex(16, 12), vertex(40, 24)}));
  CHECK_FALSE(make_scanlines({vertex(8, 8), vertex(8, 16), vertex(8, 40)}));
}

TEST_CASE("the winding of a triangle of spans is that of its vertices, in any order") {
  const Corners clockwise{vertex(8, 8), vertex(40, 8), vertex(8, 40)};
  for (std::size_t i = 0; i < 3; ++i) {
    const Corners turned{clockwise[i], clockwise[(i + 1) % 3], clockwise[(i + 2) % 3]};
    CHECK(make_scanlines(turned)->clockwise);
    CHECK_FALSE(make_scanlines({turned[0], turned[2], turned[1]})->clockwise);
  }
}

TEST_CASE("an edge too level for its slope to be a number leaves the span within the target") {
  // From x = 0 to 10^6 within 2^-149 of a pixel: dx / dy is infinite.
  const Corners corners{vertex(0.0f, 0.0f), vertex(1e6f, 0x1p-149f), vertex(-1e6f, 40.0f)};
  const auto scanlines = make_scanlines(corners);
  REQUIRE(scanlines);
  for (int y = 0; y < 40; ++y) {
    const Span span = covered_span(*scanlines, y, 0, 64);
    CHECK(span.x_begin >= 0);
    CHECK(span.x_end <= 64);
  }
}
