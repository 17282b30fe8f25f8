#include "raster/pipeline/setup.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/numbers/fixed_point.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Rectangle kClip{0, 0, 64, 64};

using Corners = std::array<WindowVertex, 3>;

WindowVertex vertex(float x, float y) { return {x, y, 0.5f, 1.0f}; }

// Clockwise as seen: y points down.
Corners clockwise() { return {vertex(8, 8), vertex(40, 8), vertex(8, 40)}; }
Corners counter_clockwise() { return {vertex(8, 8), vertex(8, 40), vertex(40, 8)}; }

Corners some_triangle(test::Random& random, float low, float high) {
  Corners corners{};
  for (WindowVertex& corner : corners) {
    const float x = random.between(low, high);
    corner = vertex(x, random.between(low, high));
  }
  return corners;
}

std::optional<TriangleSetup> set_up(const Corners& corners, const Rectangle& clip = kClip,
                                    const Profile& profile = {}) {
  return set_up_triangle(corners, Cull::none, FrontFace::counter_clockwise, clip, profile);
}

const EdgeFunctions& edges_of(const std::optional<TriangleSetup>& setup) {
  return std::get<EdgeFunctions>(setup.value().coverage);
}

}  // namespace

TEST_CASE("the corners of clip space go to the corners of the window, y downwards") {
  const WindowVertex upper_left =
      to_window({-1.0f, -1.0f, -1.0f, 1.0f}, 640, 480, Contraction::unfused);
  CHECK(upper_left.x == 0.0f);
  CHECK(upper_left.y == 0.0f);
  CHECK(upper_left.depth == 0.0f);
  const WindowVertex lower_right =
      to_window({3.0f, 3.0f, 3.0f, 3.0f}, 640, 480, Contraction::unfused);
  CHECK(lower_right.x == 640.0f);
  CHECK(lower_right.y == 480.0f);
  CHECK(lower_right.depth == 1.0f);
  CHECK(lower_right.inverse_w == 1.0f / 3.0f);
}

TEST_CASE(
    "the viewport transform multiplies by 1/w, then scales and shifts, fused where asked for") {
  test::Random random{61};
  int wrong = 0;
  int differ = 0;
  for (int i = 0; i < 10'000; ++i) {
    const glm::vec4 p{random.between(-3.0f, 3.0f), random.between(-3.0f, 3.0f),
                      random.between(-3.0f, 3.0f), random.between(0.1f, 5.0f)};
    const float r = 1.0f / p.w;
    const float x = p.x * r;
    const float y = p.y * r;
    const float z = p.z * r;
    const float scaled_x = x * 500.0f;
    const float scaled_y = y * 303.5f;
    const float scaled_z = z * 0.5f;
    const WindowVertex plain = to_window(p, 1000, 607, Contraction::unfused);
    wrong += plain.x != scaled_x + 500.0f || plain.y != scaled_y + 303.5f ||
             plain.depth != scaled_z + 0.5f || plain.inverse_w != r;
    const WindowVertex fused = to_window(p, 1000, 607, Contraction::fused);
    wrong += fused.x != std::fma(x, 500.0f, 500.0f) || fused.y != std::fma(y, 303.5f, 303.5f) ||
             fused.depth != std::fma(z, 0.5f, 0.5f) || fused.inverse_w != r;
    differ += fused.x != plain.x;
  }
  CHECK(wrong == 0);
  CHECK(differ > 100);
}

TEST_CASE("which winding is the front is the state's choice") {
  for (const bool is_clockwise : {true, false}) {
    const Corners corners = is_clockwise ? clockwise() : counter_clockwise();
    const auto front = [&](FrontFace face) {
      return set_up_triangle(corners, Cull::none, face, kClip, {})->front_facing;
    };
    CHECK(front(FrontFace::clockwise) == is_clockwise);
    CHECK(front(FrontFace::counter_clockwise) == !is_clockwise);
  }
}

TEST_CASE("culling takes away the faces it names and no others") {
  for (const FrontFace face : {FrontFace::clockwise, FrontFace::counter_clockwise}) {
    const Corners front = face == FrontFace::clockwise ? clockwise() : counter_clockwise();
    const Corners back = face == FrontFace::clockwise ? counter_clockwise() : clockwise();
    CHECK(set_up_triangle(front, Cull::back, face, kClip, {}).has_value());
    CHECK_FALSE(set_up_triangle(back, Cull::back, face, kClip, {}).has_value());
    CHECK_FALSE(set_up_triangle(front, Cull::front, face, kClip, {}).has_value());
    CHECK(set_up_triangle(back, Cull::front, face, kClip, {}).has_value());
    CHECK(set_up_triangle(front, Cull::none, face, kClip, {}).has_value());
    CHECK(set_up_triangle(back, Cull::none, face, kClip, {}).has_value());
  }
}

TEST_CASE("the area counts 1/65536 of a square pixel, twice, and is positive for both windings") {
  CHECK(edges_of(set_up(clockwise())).area == 32LL * 32 * 65536);
  CHECK(edges_of(set_up(counter_clockwise())).area == 32LL * 32 * 65536);
}

TEST_CASE("the three edge functions sum to the area at every pixel") {
  test::Random random{62};
  int wrong = 0;
  for (int i = 0; i < 2'000; ++i) {
    const auto setup = set_up(some_triangle(random, -200.0f, 260.0f));
    if (!setup) continue;
    for (int k = 0; k < 20; ++k) {
      const int x = random.whole(0, 63);
      const int y = random.whole(0, 63);
      wrong += edge_at(edges_of(setup).edges[0], x, y) + edge_at(edges_of(setup).edges[1], x, y) +
                   edge_at(edges_of(setup).edges[2], x, y) !=
               edges_of(setup).area;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("edge i is zero at the other two vertices and the area at vertex i") {
  // Vertices on pixel centres, where edge functions are evaluated.
  const std::array<std::array<int, 2>, 3> pixels{{{3, 5}, {50, 11}, {20, 60}}};
  Corners corners{};
  for (std::size_t i = 0; i < 3; ++i) {
    corners[i] =
        vertex(static_cast<float>(pixels[i][0]) + 0.5f, static_cast<float>(pixels[i][1]) + 0.5f);
  }
  for (const bool reversed : {false, true}) {
    const auto setup = set_up(reversed ? Corners{corners[0], corners[2], corners[1]} : corners);
    for (std::size_t edge = 0; edge < 3; ++edge) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t pixel = reversed && i > 0 ? 3 - i : i;
        CHECK(edge_at(edges_of(setup).edges[edge], pixels[pixel][0], pixels[pixel][1]) ==
              (edge == i ? edges_of(setup).area : 0));
      }
    }
  }
}

TEST_CASE("a left and an upper edge own the centres on them, a right and a lower one do not") {
  for (const bool reversed : {false, true}) {
    // A right angle at the upper left: edges 1 and 2 are left and upper, edge 0 (the
    // long one) is right and lower. Then the same turned by half a turn.
    Corners upper_left = clockwise();
    Corners lower_right{vertex(40, 40), vertex(8, 40), vertex(40, 8)};
    if (reversed) {
      std::swap(upper_left[1], upper_left[2]);
      std::swap(lower_right[1], lower_right[2]);
    }
    const auto a = set_up(upper_left);
    CHECK_FALSE(edges_of(a).edges[0].owns_centres);
    CHECK(edges_of(a).edges[1].owns_centres);
    CHECK(edges_of(a).edges[2].owns_centres);
    const auto b = set_up(lower_right);
    CHECK(edges_of(b).edges[0].owns_centres);
    CHECK_FALSE(edges_of(b).edges[1].owns_centres);
    CHECK_FALSE(edges_of(b).edges[2].owns_centres);
  }
}

TEST_CASE("with the lower-left rule a lower edge owns the centres on it, an upper one does not") {
  Profile profile;
  profile.fill_rule = FillRule::lower_left;
  const auto upper_left = set_up(clockwise(), kClip, profile);
  CHECK_FALSE(edges_of(upper_left).edges[0].owns_centres);
  CHECK(edges_of(upper_left).edges[1].owns_centres);  // left
  CHECK_FALSE(edges_of(upper_left).edges[2].owns_centres);
  const auto lower_right = set_up({vertex(40, 40), vertex(8, 40), vertex(40, 8)}, kClip, profile);
  CHECK(edges_of(lower_right).edges[0].owns_centres);  // left
  CHECK_FALSE(edges_of(lower_right).edges[1].owns_centres);
  CHECK(edges_of(lower_right).edges[2].owns_centres);
}

TEST_CASE("positions snap to the nearest multiple of the profile's subpixel, to the even of two") {
  test::Random random{64};
  int wrong = 0;
  for (int bits = 4; bits <= 8; ++bits) {
    Profile profile;
    profile.subpixel_bits = bits;
    const float steps = static_cast<float>(1 << bits);
    for (int i = 0; i < 1'000; ++i) {
      Corners corners = some_triangle(random, 0.0f, 64.0f);
      if (i % 4 == 0) {  // halfway between two steps
        for (WindowVertex& c : corners) c.x = (std::floor(c.x * steps) + 0.5f) / steps;
      }
      Corners rounded = corners;
      for (WindowVertex& c : rounded) {
        c.x = std::nearbyint((c.x - 0.5f) * steps) / steps + 0.5f;
        c.y = std::nearbyint((c.y - 0.5f) * steps) / steps + 0.5f;
      }
      const auto given = set_up(corners, kClip, profile);
      const auto expected = set_up(rounded);
      wrong += given.has_value() != expected.has_value();
      if (!given || !expected) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const EdgeFunction& a = edges_of(given).edges[k];
        const EdgeFunction& b = edges_of(expected).edges[k];
        wrong += a.at_origin != b.at_origin || a.per_x != b.per_x || a.per_y != b.per_y;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("by unsnapped positions a triangle without area is a back face") {
  const Corners in_line{vertex(8, 8), vertex(16, 12), vertex(40, 24)};
  for (const FrontFace face : {FrontFace::clockwise, FrontFace::counter_clockwise}) {
    CHECK(is_culled_unsnapped(in_line, Cull::back, face));
    CHECK_FALSE(is_culled_unsnapped(in_line, Cull::front, face));
    CHECK_FALSE(is_culled_unsnapped(in_line, Cull::none, face));
    const bool clockwise_is_front = face == FrontFace::clockwise;
    CHECK(is_culled_unsnapped(clockwise(), Cull::back, face) == !clockwise_is_front);
    CHECK(is_culled_unsnapped(clockwise(), Cull::front, face) == clockwise_is_front);
    CHECK(is_culled_unsnapped(counter_clockwise(), Cull::back, face) == clockwise_is_front);
  }
}

TEST_CASE("a triangle with a vertex that is not before the eye is nothing") {
  for (const float inverse_w : {0.0f, -0.0f, -1.0f}) {
    Corners corners = clockwise();
    corners[0].inverse_w = inverse_w;
    CHECK_FALSE(set_up(corners).has_value());
  }
}

TEST_CASE(
    "a triangle of no area is nothing: equal corners, corners in line, corners that snap "
    "together") {
  CHECK_FALSE(set_up({vertex(8, 8), vertex(8, 8), vertex(40, 20)}).has_value());
  CHECK_FALSE(set_up({vertex(8, 8), vertex(8, 8), vertex(8, 8)}).has_value());
  CHECK_FALSE(set_up({vertex(8, 8), vertex(16, 12), vertex(40, 24)}).has_value());
  CHECK_FALSE(set_up({vertex(8, 8), vertex(8.001f, 8), vertex(8, 8.001f)}).has_value());
}

TEST_CASE("a triangle with a coordinate that is not finite or far too large is nothing") {
  for (const float odd : {kNan, kInfinity, -kInfinity, 1e7f, -3e38f}) {
    for (std::size_t i = 0; i < 3; ++i) {
      Corners corners = clockwise();
      corners[i].x = odd;
      CHECK_FALSE(set_up(corners).has_value());
      corners = clockwise();
      corners[i].y = odd;
      CHECK_FALSE(set_up(corners).has_value());
    }
  }
  for (const float odd : {kNan, kInfinity, -kInfinity}) {
    Corners corners = clockwise();
    corners[1].depth = odd;
    CHECK_FALSE(set_up(corners).has_value());
    corners = clockwise();
    corners[2].inverse_w = odd;
    CHECK_FALSE(set_up(corners).has_value());
  }
}

TEST_CASE("the bounds are the pixels whose centres the bounding box holds, within the clip") {
  test::Random random{63};
  int wrong = 0;
  int seen = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Corners corners = some_triangle(random, -20.0f, 84.0f);
    const Rectangle clip{5, 7, 50, 61};
    const auto [x_min, x_max] =
        std::minmax({snap_to_subpixel(corners[0].x), snap_to_subpixel(corners[1].x),
                     snap_to_subpixel(corners[2].x)});
    const auto [y_min, y_max] =
        std::minmax({snap_to_subpixel(corners[0].y), snap_to_subpixel(corners[1].y),
                     snap_to_subpixel(corners[2].y)});
    Rectangle expected{1000, 1000, -1000, -1000};
    for (int p = 0; p < 64; ++p) {
      if (p >= clip.x_begin && p < clip.x_end && 256 * p >= x_min && 256 * p <= x_max) {
        expected.x_begin = std::min(expected.x_begin, p);
        expected.x_end = p + 1;
      }
      if (p >= clip.y_begin && p < clip.y_end && 256 * p >= y_min && 256 * p <= y_max) {
        expected.y_begin = std::min(expected.y_begin, p);
        expected.y_end = p + 1;
      }
    }
    const auto setup = set_up(corners, clip);
    const bool empty = expected.x_end < 0 || expected.y_end < 0;
    if (!setup) {
      wrong += !empty;
      continue;
    }
    ++seen;
    wrong += empty || setup->bounds.x_begin != expected.x_begin ||
             setup->bounds.y_begin != expected.y_begin || setup->bounds.x_end != expected.x_end ||
             setup->bounds.y_end != expected.y_end;
  }
  CHECK(wrong == 0);
  CHECK(seen > 10'000);
}
