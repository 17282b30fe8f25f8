#include "raster/pipeline/clip.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "tests/support/raster_helpers.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kPlanes = 6;

double distance_to(int plane, const glm::dvec4& p, double guard_band) {
  if (plane >= 4) return plane == 4 ? p.w + p.z : p.w - p.z;
  const double coordinate = plane < 2 ? p.x : p.y;
  return guard_band * p.w + (plane % 2 == 0 ? -coordinate : coordinate);
}

// --- the oracle: the same cuts in binary64 ---

using Polygon = std::vector<glm::dvec4>;

Polygon clip_in_double(Polygon polygon, double guard_band) {
  for (int plane = 0; plane < kPlanes; ++plane) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec4& a = polygon[i];
      const glm::dvec4& b = polygon[(i + 1) % polygon.size()];
      const double d_a = distance_to(plane, a, guard_band);
      const double d_b = distance_to(plane, b, guard_band);
      if (d_a >= 0.0) kept.push_back(a);
      if ((d_a >= 0.0) != (d_b >= 0.0)) kept.push_back(a + (b - a) * (d_a / (d_a - d_b)));
    }
    polygon = kept;
  }
  return polygon;
}

// Signed area after the division by w.
double window_area(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec4& a = polygon[i];
    const glm::dvec4& b = polygon[(i + 1) % polygon.size()];
    sum += a.x / a.w * (b.y / b.w) - b.x / b.w * (a.y / a.w);
  }
  return sum * 0.5;
}

using Corners = std::array<glm::vec4, 3>;

struct Clipped {
  ClipPolygon polygon;
  unsigned planes;  // that were cut by
};

Clipped clip(const Corners& corners, float guard_band,
             const std::array<Varyings<3>, 3>& varyings = {},
             std::span<const Interpolation> kinds = {}, Profile profile = {}) {
  profile.guard_band = guard_band;
  Clipped result{};
  result.polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    result.polygon.vertices[i].position = corners[i];
    for (std::size_t k = 0; k < 3; ++k) result.polygon.vertices[i].varyings[k] = varyings[i][k];
    result.planes |= clip_code(corners[i], guard_band);
  }
  clip_polygon(result.polygon, result.planes, kinds, profile);
  return result;
}

Polygon positions(const ClipPolygon& polygon) {
  Polygon points;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    points.emplace_back(polygon.vertices[i].position);
  }
  return points;
}

Polygon positions(const Corners& corners) {
  return {glm::dvec4{corners[0]}, glm::dvec4{corners[1]}, glm::dvec4{corners[2]}};
}

// A point that is outside of each pair of planes about every second time.
glm::vec4 some_point(test::Random& random, float guard_band) {
  const float w = random.between(0.5f, 4.0f);
  const auto coordinate = [&](float limit) { return random.between(-2.0f, 2.0f) * limit * w; };
  const float x = coordinate(guard_band);
  const float y = coordinate(guard_band);
  return {x, y, coordinate(1.0f), w};
}

Corners some_triangle(test::Random& random, float guard_band) {
  Corners corners{};
  for (glm::vec4& corner : corners) corner = some_point(random, guard_band);
  return corners;
}

double size_of(const Corners& corners) {
  double size = 0.0;
  for (const glm::vec4& corner : corners) {
    for (int i = 0; i < 4; ++i) size = std::max<double>(size, std::fabs(corner[i]));
  }
  return size;
}

int bit_count(unsigned code) {
  int count = 0;
  for (; code != 0; code &= code - 1) ++count;
  return count;
}

}  // namespace

TEST_CASE("a point is outside of the planes that it is beyond, and of no others") {
  const float g = 16.0f;
  CHECK(clip_code({0.0f, 0.0f, 0.0f, 1.0f}, g) == 0);
  CHECK(clip_code({16.1f, 0.0f, 0.0f, 1.0f}, g) == 1u << 0);
  CHECK(clip_code({-16.1f, 0.0f, 0.0f, 1.0f}, g) == 1u << 1);
  CHECK(clip_code({0.0f, 16.1f, 0.0f, 1.0f}, g) == 1u << 2);
  CHECK(clip_code({0.0f, -16.1f, 0.0f, 1.0f}, g) == 1u << 3);
  CHECK(clip_code({0.0f, 0.0f, -1.01f, 1.0f}, g) == 1u << 4);
  CHECK(clip_code({0.0f, 0.0f, 1.01f, 1.0f}, g) == 1u << 5);
  CHECK(clip_code({17.0f, -17.0f, -2.0f, 1.0f}, g) == (1u << 0 | 1u << 3 | 1u << 4));
}

TEST_CASE("a point on a plane is inside of it") {
  const float g = 2.0f;
  for (const glm::vec4 point :
       {glm::vec4{0, 0, -1, 1}, glm::vec4{0, 0, 1, 1}, glm::vec4{-2, 0, 0, 1},
        glm::vec4{2, 0, 0, 1}, glm::vec4{0, -2, 0, 1}, glm::vec4{0, 2, 0, 1}, glm::vec4{2, 2, 1, 1},
        glm::vec4{0, 0, 0, 0}}) {
    CHECK(clip_code(point, g) == 0);
  }
}

TEST_CASE("a point behind the eye is outside") {
  CHECK(clip_code({0.0f, 0.0f, 0.0f, -1.0f}, 16.0f) != 0);
  CHECK(clip_code({0.5f, 0.5f, 3.0f, -1.0f}, 16.0f) != 0);
}

TEST_CASE("a point with a NaN or infinite component is outside of kNotFinite") {
  for (int i = 0; i < 4; ++i) {
    for (const float odd : {kNan, kInfinity, -kInfinity}) {
      glm::vec4 point{0.0f, 0.0f, 0.0f, 1.0f};
      point[i] = odd;
      CHECK(clip_code(point, 16.0f) == kNotFinite);
    }
  }
}

TEST_CASE("a triangle with one corner beyond a plane becomes a quadrangle, with two a triangle") {
  const std::array<glm::vec4, kPlanes> beyond{glm::vec4{0, 0, -3, 1}, {0, 0, 3, 1},  {-3, 0, 0, 1},
                                              {3, 0, 0, 1},           {0, -3, 0, 1}, {0, 3, 0, 1}};
  for (const glm::vec4& out : beyond) {
    const glm::vec4 in{0.1f, 0.2f, 0.0f, 1.0f};
    const glm::vec4 nudge{0.1f, -0.1f, 0.1f, 0.0f};
    CHECK(clip({in, in + nudge, out}, 1.0f).polygon.count == 4);
    CHECK(clip({in, out + nudge, out}, 1.0f).polygon.count == 3);
    CHECK(clip({out, out + nudge, out - nudge}, 1.0f).polygon.count == 0);
  }
}

TEST_CASE("clipping makes new vertices only on a plane, and leaves none outside") {
  test::Random random{51};
  int wrong = 0;
  for (const float g : {1.0f, 2.0f, 16.0f}) {
    for (int i = 0; i < fewer(20'000); ++i) {
      const Corners corners = some_triangle(random, g);
      const Clipped clipped = clip(corners, g);
      const double tolerance = size_of(corners) * std::max(1.0f, g) * 8 * 0x1p-24;
      for (const glm::dvec4& p : positions(clipped.polygon)) {
        const auto is_p = [&](const glm::vec4& c) { return glm::dvec4{c} == p; };
        bool accounted = std::any_of(corners.begin(), corners.end(), is_p);
        for (int plane = 0; plane < kPlanes; ++plane) {
          const double distance = distance_to(plane, p, g);
          wrong += distance < -tolerance;
          accounted = accounted || std::fabs(distance) <= tolerance;
        }
        wrong += !accounted;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE(
    "clipping by every plane, pair and triple of planes keeps the area that a clip in binary64 "
    "keeps") {
  test::Random random{52};
  std::map<unsigned, int> kept_by_planes;
  double worst = 0.0;
  for (int i = 0; i < fewer(200'000); ++i) {
    const Corners corners = some_triangle(random, 1.0f);
    const Clipped clipped = clip(corners, 1.0f);
    const double exact = window_area(clip_in_double(positions(corners), 1.0));
    worst = std::max(worst, std::fabs(window_area(positions(clipped.polygon)) - exact));
    if (std::fabs(exact) > 0.01 && bit_count(clipped.planes) <= 3) ++kept_by_planes[clipped.planes];
  }
  // The window is 2 x 2; corners of up to 16 are rounded to 2^-20 before a division by
  // 0.5 or more.
  CHECK(worst < 2e-5);
  CHECK(kept_by_planes.size() == 1 + 6 + 15 + 20);
}

TEST_CASE("a triangle from behind the eye is cut at the near plane") {
  // Eye space to clip space with near 0.5 and far 10: w is the distance.
  test::Random random{53};
  int cut = 0;
  double worst = 0.0;
  for (int i = 0; i < fewer(50'000); ++i) {
    Corners corners{};
    for (glm::vec4& corner : corners) {
      const float distance = random.between(-6.0f, 9.0f);
      corner = {random.between(-4.0f, 4.0f), random.between(-4.0f, 4.0f),
                (10.5f * distance - 10.0f) / 9.5f, distance};
    }
    const Clipped clipped = clip(corners, 4.0f);
    if ((clipped.planes & 1u << 4) == 0) continue;
    const Polygon exact = clip_in_double(positions(corners), 4.0);
    cut += !exact.empty();
    for (const glm::dvec4& p : positions(clipped.polygon)) {
      if (!(p.w > 0.49)) worst = kInfinity;
    }
    worst =
        std::max(worst, std::fabs(window_area(positions(clipped.polygon)) - window_area(exact)));
  }
  CHECK(cut > fewer(10'000));
  CHECK(worst < 1e-3);  // of 64
}

TEST_CASE("a triangle wholly outside of one plane vanishes") {
  test::Random random{54};
  int wrong = 0;
  for (int i = 0; i < fewer(20'000); ++i) {
    const Corners corners = some_triangle(random, 2.0f);
    unsigned all = ~0u;
    for (const glm::vec4& corner : corners) all &= clip_code(corner, 2.0f);
    wrong += all != 0 && clip(corners, 2.0f).polygon.count != 0;
  }
  CHECK(wrong == 0);
}

TEST_CASE("a triangle inside is not touched") {
  const Corners corners{
      glm::vec4{0.5f, 0.5f, 0.0f, 1.0f}, {-0.5f, 0.5f, 0.5f, 1.0f}, {0.0f, -1.0f, -1.0f, 1.0f}};
  const Clipped clipped = clip(corners, 1.0f);
  CHECK(clipped.planes == 0);
  CHECK(positions(clipped.polygon) == positions(corners));
}

TEST_CASE("two triangles with a common edge get identical new vertices on it") {
  constexpr std::array kKinds{Interpolation::perspective};
  test::Random random{55};
  int shared = 0;
  int different = 0;
  for (const float g : {1.0f, 2.0f, 16.0f}) {
    for (int i = 0; i < fewer(20'000); ++i) {
      const Corners corners = some_triangle(random, g);
      const glm::vec4 other = some_point(random, g);
      // The varying is 0 on the edge and nowhere else.
      const std::array<Varyings<3>, 3> marks{Varyings<3>{0.0f}, {0.0f}, {1.0f}};
      const Clipped one = clip(corners, g, marks, kKinds);
      const Clipped two = clip({corners[1], corners[0], other}, g, marks, kKinds);
      const auto on_edge = [](const ClipPolygon& polygon) {
        std::vector<std::array<float, 4>> points;
        for (std::size_t k = 0; k < polygon.count; ++k) {
          const glm::vec4& p = polygon.vertices[k].position;
          if (polygon.vertices[k].varyings[0] == 0.0f) points.push_back({p.x, p.y, p.z, p.w});
        }
        std::sort(points.begin(), points.end());
        return points;
      };
      const auto points = on_edge(one.polygon);
      shared += points.size() == 2;
      different += points != on_edge(two.polygon);
    }
  }
  CHECK(shared > fewer(5'000));
  CHECK(different == 0);
}

TEST_CASE("a new vertex is computed from the end that is nearer to the plane") {
  constexpr std::array kKinds{Interpolation::perspective};
  test::Random random{62};
  int wrong = 0;
  int other_end_differs = 0;
  for (int i = 0; i < 1'000; ++i) {
    const float in = random.between(-1.0f, 1.0f);
    const float out = random.between(-1.0f, 1.0f);
    const auto cut = [&](float x_inside, float x_outside) {
      const glm::vec4 beyond{x_outside, 0.0f, 0.0f, 4.0f};
      const Corners corners{glm::vec4{x_inside, 0.0f, 0.0f, 4.0f}, beyond, beyond};
      const Clipped clipped = clip(corners, 1.0f, {Varyings<3>{in}, {out}, {out}}, kKinds);
      wrong += clipped.polygon.count != 3;
      wrong += clipped.polygon.vertices[1].position != glm::vec4{4.0f, 0.0f, 0.0f, 4.0f};
      return clipped.polygon.vertices[1].varyings[0];
    };
    wrong += cut(2.0f, 10.0f) != in + 0.25f * (out - in);
    wrong += cut(-2.0f, 6.0f) != out + 0.25f * (in - out);
    wrong += cut(0.0f, 8.0f) != in + 0.5f * (out - in);
    other_end_differs += out + 0.25f * (in - out) != in + 0.75f * (out - in);
  }
  CHECK(wrong == 0);
  CHECK(other_end_differs > 100);
}

TEST_CASE("only the vertices that clipping makes are marked as new") {
  const Clipped clipped =
      clip({glm::vec4{0.0f, 0.5f, 0.0f, 1.0f}, {3.0f, 0.0f, 0.0f, 1.0f}, {0.0f, -0.5f, 0.0f, 1.0f}},
           1.0f);
  REQUIRE(clipped.polygon.count == 4);
  const auto& v = clipped.polygon.vertices;
  CHECK_FALSE(v[0].is_new);
  CHECK(v[1].is_new);
  CHECK(v[2].is_new);
  CHECK_FALSE(v[3].is_new);
}

TEST_CASE("a polygon at an infinite distance from a plane vanishes") {
  const Corners corners{
      glm::vec4{0.0f, 0.0f, 0.0f, 1.0f}, {3e38f, 0.0f, 0.0f, -3e38f}, {0.0f, 0.5f, 0.0f, 1.0f}};
  CHECK(clip(corners, 1.0f).polygon.count == 0);
}

TEST_CASE("a perspective varying stays linear in clip space through clipping") {
  constexpr std::array kKinds{Interpolation::perspective};
  const auto plane = [](const glm::dvec4& p) { return 2.0 * p.x - 3.0 * p.y + p.z + 0.5 * p.w; };
  test::Random random{56};
  double worst = 0.0;
  for (int i = 0; i < fewer(20'000); ++i) {
    const Corners corners = some_triangle(random, 1.0f);
    std::array<Varyings<3>, 3> varyings{};
    for (std::size_t k = 0; k < 3; ++k) {
      varyings[k][0] = static_cast<float>(plane(glm::dvec4{corners[k]}));
    }
    const Clipped clipped = clip(corners, 1.0f, varyings, kKinds);
    for (std::size_t k = 0; k < clipped.polygon.count; ++k) {
      const ClipVertex& vertex = clipped.polygon.vertices[k];
      worst = std::max(worst, std::fabs(static_cast<double>(vertex.varyings[0]) -
                                        plane(glm::dvec4{vertex.position})));
    }
  }
  CHECK(worst < 1e-4);  // values reach 50
}

TEST_CASE("a linear varying stays linear in the window through clipping") {
  constexpr std::array kKinds{Interpolation::linear};
  const auto plane = [](const glm::dvec4& p) { return 2.0 * p.x / p.w - 3.0 * p.y / p.w + 0.5; };
  test::Random random{57};
  double worst = 0.0;
  double worst_of_mesa = 0.0;
  for (int i = 0; i < fewer(20'000); ++i) {
    const Corners corners = some_triangle(random, 1.0f);
    std::array<Varyings<3>, 3> varyings{};
    for (std::size_t k = 0; k < 3; ++k) {
      varyings[k][0] = static_cast<float>(plane(glm::dvec4{corners[k]}));
    }
    const auto error = [&](const ClipVertex& vertex) {
      return std::fabs(static_cast<double>(vertex.varyings[0]) -
                       plane(glm::dvec4{vertex.position}));
    };
    const Clipped clipped = clip(corners, 1.0f, varyings, kKinds);
    for (std::size_t k = 0; k < clipped.polygon.count; ++k) {
      worst = std::max(worst, error(clipped.polygon.vertices[k]));
    }
    // By the images' x, of vertices made by one plane only and not on upright edges.
    const Clipped mesa = clip(corners, 1.0f, varyings, kKinds, test::profile_named("llvmpipe"));
    if (bit_count(mesa.planes) != 1) continue;
    for (std::size_t k = 0; k < mesa.polygon.count; ++k) {
      bool upright = false;
      for (std::size_t a = 0; a < 3; ++a) {
        const glm::vec4& p = corners[a];
        const glm::vec4& q = corners[(a + 1) % 3];
        upright = upright || std::fabs(p.x / p.w - q.x / q.w) < 0.1f;
      }
      if (!upright) worst_of_mesa = std::max(worst_of_mesa, error(mesa.polygon.vertices[k]));
    }
  }
  CHECK(worst < 1e-4);  // values reach 10
  CHECK(worst_of_mesa < 1e-3);
  CHECK(worst_of_mesa > 0.0);
}

TEST_CASE("in Mesa's drivers a linear varying is lost on an edge along the picture's side") {
  // Cut by x = w and then by y = w: the second cut is on an edge whose ends are both at
  // window x = 1, at different clip x.
  constexpr std::array kKinds{Interpolation::linear};
  const Corners corners{
      glm::vec4{0.0f, 0.0f, 0.0f, 1.0f}, {4.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 8.0f, 0.0f, 2.0f}};
  const std::array<Varyings<3>, 3> varyings{Varyings<3>{1.0f}, {1.0f}, {1.0f}};
  const auto lost = [&](const Profile& profile) {
    const ClipPolygon polygon = clip(corners, 1.0f, varyings, kKinds, profile).polygon;
    CHECK(polygon.count == 4);
    int count = 0;
    for (std::size_t k = 0; k < polygon.count; ++k) {
      count += !(polygon.vertices[k].varyings[0] == 1.0f);
    }
    return count;
  };
  CHECK(lost(test::profile_named("softpipe")) == 1);
  CHECK(lost(test::profile_named("ieee")) == 0);
}

TEST_CASE("a flat varying goes through clipping as it is, infinite or NaN") {
  constexpr std::array kKinds{Interpolation::flat, Interpolation::flat, Interpolation::flat};
  const Varyings<3> odd{kInfinity, kNan, -0.0f};
  test::Random random{61};
  int wrong = 0;
  for (int i = 0; i < 1'000; ++i) {
    const Clipped clipped = clip(some_triangle(random, 1.0f), 1.0f, {odd, odd, odd}, kKinds);
    for (std::size_t k = 0; k < clipped.polygon.count; ++k) {
      const auto& v = clipped.polygon.vertices[k].varyings;
      wrong += v[0] != kInfinity || !std::isnan(v[1]) || v[2] != 0.0f || !std::signbit(v[2]);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("equal varyings stay equal to the bit through clipping") {
  constexpr std::array kKinds{Interpolation::perspective, Interpolation::linear,
                              Interpolation::flat};
  test::Random random{58};
  int wrong = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Varyings<3> same{0.1f, -7.3f, 1e20f};
    const Clipped clipped = clip(some_triangle(random, 1.0f), 1.0f, {same, same, same}, kKinds);
    for (std::size_t k = 0; k < clipped.polygon.count; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        wrong += clipped.polygon.vertices[k].varyings[j] != same[j];
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a sliver through corners of the frustum gets one vertex more from each plane") {
  // Found by chance among 8,000,000 triangles with corners within a few floats of the
  // frustum's.
  const Corners nine{glm::vec4{0x1.3e97dcp+0f, 0x1.3e97dap+0f, -0x1.3e97d2p+0f, 0x1.3e97dap+0f},
                     {-0x1.3816c4p+0f, 0x1.3816c6p+0f, -0x1.613e66p+1f, 0x1.3816c2p+0f},
                     {-0x1.63edacp+0f, -0x1.9d2878p+1f, 0x1.06c3dcp+2f, 0x1.63edaep+0f}};
  CHECK(clip(nine, 1.0f).polygon.count == 9);
}

TEST_CASE("triangles with corners on and a float beside the planes keep to the frustum") {
  test::Random random{59};
  std::size_t most = 0;
  int wrong = 0;
  for (int i = 0; i < fewer(200'000); ++i) {
    const float g = i % 3 == 0 ? 1.0f : i % 3 == 1 ? 2.0f : 16.0f;
    Corners corners{};
    for (glm::vec4& corner : corners) {
      const float w = random.between(0.5f, 1.5f);
      const auto coordinate = [&](float limit) {
        float value = random.whole(0, 1) == 0 ? -limit * w : limit * w;
        for (int steps = random.whole(0, 4); steps > 0; --steps) {
          value = std::nextafter(value, random.between(-100.0f, 100.0f));
        }
        return random.whole(0, 5) == 0 ? value * random.between(0.9f, 3.0f) : value;
      };
      const float x = coordinate(g);
      const float y = coordinate(g);
      corner = {x, y, coordinate(1.0f), w};
    }
    const ClipPolygon polygon = clip(corners, g).polygon;
    most = std::max(most, polygon.count);
    for (const glm::dvec4& p : positions(polygon)) {
      for (int plane = 0; plane < kPlanes; ++plane) wrong += distance_to(plane, p, g) < -1e-4;
    }
  }
  CHECK(wrong == 0);
  CHECK(most >= 8);
}

TEST_CASE("the largest finite positions clip without harm") {
  test::Random random{60};
  int wrong = 0;
  for (int i = 0; i < fewer(50'000); ++i) {
    Corners corners{};
    for (glm::vec4& corner : corners) {
      for (int k = 0; k < 4; ++k) {
        corner[k] = std::ldexp(random.between(-1.9f, 1.9f), random.whole(0, 3) == 0 ? 127 : 0);
      }
    }
    const ClipPolygon polygon = clip(corners, 16.0f).polygon;
    wrong += polygon.count > polygon.vertices.size();
  }
  CHECK(wrong == 0);
}
