// Depth and varyings at the pixels of a triangle.

#include "raster/pipeline/interpolate.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/numbers/vector_math.h"
#include "raster/pipeline/draw.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

constexpr Interpolation kPerspective = Interpolation::perspective;
constexpr Interpolation kLinear = Interpolation::linear;
constexpr Interpolation kFlat = Interpolation::flat;
constexpr int kSize = 64;
constexpr Rectangle kTarget{0, 0, kSize, kSize};

// Triangles of at least some pixels, seen from the eye with z forward, near 0.5, far 50.
struct Seen {
  std::array<glm::vec3, 3> space;
  std::array<glm::vec4, 3> clip;
};

glm::vec4 project(glm::vec3 p) { return {p.x, p.y, (50.5f * p.z - 50.0f) / 49.5f, p.z}; }

Seen some_triangle(test::Random& random) {
  Seen seen{};
  for (std::size_t i = 0; i < 3; ++i) {
    const float z = random.between(1.0f, 40.0f);
    const float x = random.between(-1.5f, 1.5f) * z;
    seen.space[i] = {x, random.between(-1.5f, 1.5f) * z, z};
    seen.clip[i] = project(seen.space[i]);
  }
  return seen;
}

template <std::size_t N>
std::optional<Triangle<N>> set_up(const std::array<glm::vec4, 3>& clip,
                                  const std::array<Varyings<N>, 3>& varyings,
                                  const Profile& profile = {}) {
  std::array<WindowVertex, 3> window{};
  for (std::size_t i = 0; i < 3; ++i)
    window[i] = to_window(clip[i], kSize, kSize, profile.viewport);
  const auto setup = set_up_triangle(window, Cull::none, FrontFace::clockwise, kTarget, profile);
  if (!setup) return std::nullopt;
  return Triangle<N>{*setup, varyings, 2};
}

// Calls visit(x, y) for the covered pixels.
template <class Visit>
void for_each_pixel(const TriangleSetup& setup, Visit visit) {
  for (int y = setup.bounds.y_begin; y < setup.bounds.y_end; ++y) {
    const Span span = covered_span(setup, y, setup.bounds.x_begin, setup.bounds.x_end);
    for (int x = span.x_begin; x < span.x_end; ++x) visit(x, y);
  }
}

template <std::size_t N>
using InterpolatorFromOrigin = PlaneInterpolator<PlanesFromOrigin, N>;
template <std::size_t N>
using InterpolatorByQuad = PlaneInterpolator<PlanesByQuad, N>;

// The linear and perspective weights of a pixel's centre in binary64, from snapped
// positions (the triangle that is drawn) or unsnapped ones.
struct Weights {
  std::array<double, 3> linear;
  std::array<double, 3> perspective;
};

Weights exact_weights(const TriangleSetup& setup, int x, int y, bool snapped) {
  std::array<glm::dvec2, 3> p;
  for (std::size_t i = 0; i < 3; ++i) {
    const WindowVertex& v = setup.vertices[i];
    p[i] = snapped ? glm::dvec2{snap_to_subpixel(v.x) / 256.0 + 0.5,
                                snap_to_subpixel(v.y) / 256.0 + 0.5}
                   : glm::dvec2{v.x, v.y};
  }
  const glm::dvec2 centre{x + 0.5, y + 0.5};
  const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
  const double area = cross(p[1] - p[0], p[2] - p[0]);
  Weights weights{};
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2& a = p[(i + 1) % 3];
    weights.linear[i] = cross(p[(i + 2) % 3] - a, centre - a) / area;
    weights.perspective[i] = weights.linear[i] * setup.vertices[i].inverse_w;
    sum += weights.perspective[i];
  }
  for (double& weight : weights.perspective) weight /= sum;
  return weights;
}

// Largest error, as a multiple of 2^-24 of the largest vertex value, of an interpolator's
// perspective and linear varyings and of depth against the exact weights.
template <template <std::size_t> class Interpolator>
double error_against_weights(const Profile& profile, bool snapped, std::uint64_t seed,
                             float smallest_area) {
  constexpr std::array kKinds{kPerspective, kLinear};
  test::Random random{seed};
  double worst = 0.0;
  for (int t = 0; t < 400; ++t) {
    const Seen seen = some_triangle(random);
    std::array<Varyings<2>, 3> varyings{};
    for (auto& v : varyings) v[0] = v[1] = random.between(-1.0f, 1.0f);
    const auto triangle = set_up<2>(seen.clip, varyings, profile);
    if (!triangle || std::fabs(unsnapped_area(triangle->setup.vertices)) < smallest_area) continue;
    const Interpolator<2> interpolator{*triangle, profile, kKinds};
    for_each_pixel(triangle->setup, [&](int x, int y) {
      const auto value = interpolator.at(x, y);
      const Weights weights = exact_weights(triangle->setup, x, y, snapped);
      double perspective = 0.0;
      double linear = 0.0;
      double depth = 0.0;
      for (std::size_t i = 0; i < 3; ++i) {
        perspective += weights.perspective[i] * varyings[i][0];
        linear += weights.linear[i] * varyings[i][1];
        depth += weights.linear[i] * triangle->setup.vertices[i].depth;
      }
      worst = std::max({worst, std::fabs(value.varyings[0] - perspective),
                        std::fabs(value.varyings[1] - linear), std::fabs(value.depth - depth)});
    });
  }
  return worst / 0x1p-24;
}

// A fragment stage that gives one of its values in four channels.
enum class Give { values, ddx, ddy };
template <Interpolation kind, Give give, bool derivatives = true>
struct GiveFour {
  static constexpr std::array kInterpolation{kind, kind, kind, kind};
  static constexpr bool kNeedsDerivatives = derivatives;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<4>& f) const {
    const auto& v = give == Give::values ? f.varyings : give == Give::ddx ? f.ddx : f.ddy;
    return {{glm::vec4{v[0], v[1], v[2], v[3]}}, false};
  }
};

Image draw_four(const std::vector<VertexOutput<4>>& vertices, auto stage,
                const Profile& profile = {}, int width = kSize, int height = kSize) {
  Image target = make_image(Format::rgba32f, width, height);
  test::draw_list({.colour = {&target}}, test::plain_state(), vertices, stage, profile);
  return target;
}

// A slanted rectangle that fills the view, with texture-like varyings.
std::vector<VertexOutput<4>> slanted_floor() {
  std::vector<VertexOutput<4>> vertices;
  const auto corner = [](float x, float y, float z) {
    return VertexOutput<4>{project({x * z, y * z, z}), {x * z, y * z, z, 7.0f * x + 3.0f}};
  };
  const VertexOutput<4> a = corner(-1.2f, -1.2f, 1.0f);
  const VertexOutput<4> b = corner(1.2f, -1.2f, 3.0f);
  const VertexOutput<4> c = corner(1.2f, 1.2f, 9.0f);
  const VertexOutput<4> d = corner(-1.2f, 1.2f, 5.0f);
  return {a, b, c, a, c, d};
}

// Largest difference of two images, over all channels; infinite if only one is NaN.
double largest_difference(const Image& a, const Image& b) {
  double worst = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      for (int i = 0; i < 4; ++i) {
        const double difference = std::fabs(load_texel(a, x, y)[i] - load_texel(b, x, y)[i]);
        if (!(difference <= worst)) worst = difference;
      }
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("barycentric interpolation is within rounding of exact weights, for all triangles") {
  CHECK(error_against_weights<BarycentricInterpolator>(profile_named("ieee"), true, 81, 0.0f) <
        8.0);
}

TEST_CASE("plane interpolation is near exact weights of the unsnapped triangle, slivers aside") {
  // Planes are evaluated from the origin: they lose what the slope is large for.
  constexpr float kTenSquarePixels = 2.0f * 10.0f;
  for (const std::string_view name : {"llvmpipe", "llvmpipe-sse41"}) {
    CHECK_MESSAGE(error_against_weights<InterpolatorFromOrigin>(profile_named(name), false, 82,
                                                                kTenSquarePixels) < 800.0,
                  name);
  }
  CHECK(error_against_weights<InterpolatorByQuad>(profile_named("softpipe"), false, 82,
                                                  kTenSquarePixels) < 800.0);
}

TEST_CASE("a plane in space comes back from its varyings: the position seen at each pixel") {
  // Position in space as three varyings, projected again, is the pixel's centre, up to
  // snapping (1/512 pixel) and rounding; and it lies on the triangle's plane.
  constexpr std::array kKinds{kPerspective, kPerspective, kPerspective};
  test::Random random{83};
  double worst_window = 0.0;
  double worst_plane = 0.0;
  int pixels = 0;
  for (int t = 0; t < 400; ++t) {
    const Seen seen = some_triangle(random);
    std::array<Varyings<3>, 3> varyings{};
    for (std::size_t i = 0; i < 3; ++i)
      varyings[i] = {seen.space[i].x, seen.space[i].y, seen.space[i].z};
    const auto triangle = set_up<3>(seen.clip, varyings);
    if (!triangle) continue;
    const glm::dvec3 origin{seen.space[0]};
    const glm::dvec3 side_1 = glm::dvec3{seen.space[1]} - origin;
    const glm::dvec3 side_2 = glm::dvec3{seen.space[2]} - origin;
    const glm::dvec3 normal = normalize(cross(side_1, side_2));
    const BarycentricInterpolator<3> interpolator{*triangle, Profile{}, kKinds};
    for_each_pixel(triangle->setup, [&](int x, int y) {
      const auto v = interpolator.at(x, y).varyings;
      const glm::dvec3 p{v[0], v[1], v[2]};
      worst_window = std::max({worst_window, std::fabs((p.x / p.z + 1.0) * 32.0 - (x + 0.5)),
                               std::fabs((p.y / p.z + 1.0) * 32.0 - (y + 0.5))});
      worst_plane = std::max(worst_plane, std::fabs(dot(normal, p - origin)));
      ++pixels;
    });
  }
  CHECK(pixels > 50'000);
  CHECK(worst_window < 1.0 / 512.0 + 5e-4);
  CHECK(worst_plane < 1e-4);  // of positions up to 60
}

TEST_CASE("a perspective varying halfway across is nearer the closer vertex's value") {
  // From w = 1 to w = 3: at the middle of the window (1/2 a/1 + 1/2 b/3) / (1/2 + 1/6).
  const std::vector<VertexOutput<4>> vertices{
      {{-1, -8, 0, 1}, {0, 0, 0, 0}}, {{3, -24, 0, 3}, {1, 1, 1, 1}},
      {{-1, 8, 0, 1}, {0, 0, 0, 0}},  {{-1, 8, 0, 1}, {0, 0, 0, 0}},
      {{3, -24, 0, 3}, {1, 1, 1, 1}}, {{3, 24, 0, 3}, {1, 1, 1, 1}}};
  const Image perspective = draw_four(vertices, GiveFour<kPerspective, Give::values>{});
  const Image linear = draw_four(vertices, GiveFour<kLinear, Give::values>{});
  for (int x = 0; x < kSize; ++x) {
    const double s = (x + 0.5) / kSize;
    CHECK(load_texel(perspective, x, 20).x ==
          doctest::Approx(s / 3.0 / (1.0 - s + s / 3.0)).epsilon(1e-5));
    CHECK(load_texel(linear, x, 20).x == doctest::Approx(s).epsilon(1e-5));
  }
}

TEST_CASE("a flat varying has the provoking vertex's value at every pixel, to the bit") {
  test::Random random{84};
  int wrong = 0;
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    std::vector<VertexOutput<4>> vertices;
    for (int i = 0; i < 3; ++i) {
      const auto v = static_cast<float>(i + 1);
      vertices.push_back({some_triangle(random).clip[0], {0.1f * v, 1e20f * v, -v, 3.0f / v}});
    }
    const auto& v = vertices[2].varyings;
    const glm::vec4 last{v[0], v[1], v[2], v[3]};
    const Image target = draw_four(vertices, GiveFour<kFlat, Give::values>{}, profile);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const glm::vec4 value = load_texel(target, x, y);
        wrong += value != glm::vec4{0.0f} && value != last;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a varying that is the same at all three vertices comes out unchanged") {
  constexpr std::array kKinds{kPerspective, kLinear, kFlat};
  test::Random random{85};
  int wrong = 0;
  for (int t = 0; t < 400; ++t) {
    const float value = std::ldexp(random.between(-1.0f, 1.0f), random.whole(-30, 30));
    const Varyings<3> same{value, value, value};
    const auto triangle = set_up<3>(some_triangle(random).clip, {same, same, same});
    if (!triangle) continue;
    const BarycentricInterpolator<3> interpolator{*triangle, Profile{}, kKinds};
    for_each_pixel(triangle->setup,
                   [&](int x, int y) { wrong += interpolator.at(x, y).varyings != same; });
  }
  CHECK(wrong == 0);
}

TEST_CASE("interpolated values stay within rounding of the vertices' range on any sliver") {
  constexpr std::array kKinds{kPerspective, kLinear};
  test::Random random{86};
  double worst = 0.0;
  int pixels = 0;
  for (int t = 0; t < 100'000; ++t) {
    std::array<glm::vec4, 3> clip{};
    const glm::vec2 a{random.between(0.0f, 64.0f), random.between(0.0f, 64.0f)};
    const glm::vec2 b{random.between(0.0f, 64.0f), random.between(0.0f, 64.0f)};
    const glm::vec2 near_line =
        a + (b - a) * random.between(0.0f, 1.0f) +
        glm::vec2{random.between(-0.02f, 0.02f), random.between(-0.02f, 0.02f)};
    const std::array<glm::vec2, 3> window{a, b, near_line};
    for (std::size_t i = 0; i < 3; ++i) {
      clip[i] = test::at_window(window[i], kSize, kSize) * random.between(0.5f, 30.0f);
    }
    const auto triangle = set_up<2>(clip, {Varyings<2>{0.0f, 1.0f}, {1.0f, 0.0f}, {0.5f, 0.25f}});
    if (!triangle) continue;
    const BarycentricInterpolator<2> interpolator{*triangle, Profile{}, kKinds};
    for_each_pixel(triangle->setup, [&](int x, int y) {
      const auto value = interpolator.at(x, y);
      for (const float v : value.varyings) {
        worst = std::max({worst, -static_cast<double>(v), static_cast<double>(v) - 1.0});
      }
      ++pixels;
    });
  }
  CHECK(pixels > 10'000);
  CHECK(worst < 8 * 0x1p-24);
}

TEST_CASE("the depth that a draw stores runs from 0 at the near plane to 1 at the far one") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    // A wall from the near plane on the left to beyond the far plane on the right.
    const std::vector<VertexOutput<0>> vertices{
        {{-1, -8, -1, 1}, {}}, {{1.5f, -8, 1.5f, 1}, {}}, {{-1, 8, -1, 1}, {}},
        {{-1, 8, -1, 1}, {}},  {{1.5f, -8, 1.5f, 1}, {}}, {{1.5f, 8, 1.5f, 1}, {}}};
    Image depth = make_image(Format::r32f, kSize, kSize);
    clear_image(depth, glm::vec4{2.0f}, {});
    DrawState state = test::plain_state();
    state.depth = DepthState{Compare::always, true};
    test::draw_list({.depth = &depth}, state, vertices, test::OneColour{}, profile);
    int outside = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double value = load_texel(depth, x, y).x;
        outside += !(value >= 0.0 && value <= 1.0);
        outside += std::fabs(value - (x + 0.5) / kSize) > 1e-5;
      }
    }
    CHECK_MESSAGE(outside == 0, known.name);
  }
}

TEST_CASE("depth never leaves 0 to 1, on any triangle and in any profile but softpipe") {
  test::Random random{87};
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    if (known.name == "softpipe") continue;
    std::vector<VertexOutput<0>> vertices;
    for (int i = 0; i < 3 * 500; ++i) {
      glm::vec4 p{random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f), 0.0f, 1.0f};
      p.z = random.whole(0, 2) == 0   ? random.between(-1.5f, 1.5f)
            : random.whole(0, 1) == 0 ? -1.0f
                                      : 1.0f;
      vertices.push_back({p * random.between(0.1f, 9.0f), {}});
    }
    Image depth = make_image(Format::r32f, kSize, kSize);
    DrawState state = test::plain_state();
    int outside = 0;
    for (const Compare test : {Compare::greater, Compare::less}) {
      state.depth = DepthState{test, true};
      clear_image(depth, glm::vec4{0.5f}, {});
      test::draw_list({.depth = &depth}, state, vertices, test::OneColour{}, profile);
      for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
          const float value = load_texel(depth, x, y).x;
          outside += !(value >= 0.0f && value <= 1.0f);
        }
      }
    }
    CHECK_MESSAGE(outside == 0, known.name);
  }
}

TEST_CASE("softpipe stores the depth that a sliver's plane gives beyond its vertices, unclamped") {
  // In 1/65536 pixel; two vertices on the far plane, one on the near plane.
  const auto corner = [](float x, float y, float z) {
    return VertexOutput<0>{test::at_window(glm::vec2{x, y} / 65536.0f, 16, 16, z), {}};
  };
  const std::vector<VertexOutput<0>> sliver{
      corner(229375, 163859, 1.0f), corner(819213, 753637, 1.0f), corner(364236, 298707, -1.0f)};
  const auto drawn = [&](std::string_view name) {
    Image depth = make_image(Format::r32f, 16, 16);
    DrawState state = test::plain_state();
    state.depth = DepthState{Compare::always, true};
    test::draw_list({.depth = &depth}, state, sliver, test::OneColour{}, profile_named(name));
    return load_texel(depth, 6, 5).x;
  };
  CHECK(drawn("softpipe") == 1.078125f);
  CHECK(drawn("llvmpipe") <= 1.0f);
}

TEST_CASE("both ways of interpolating agree within a few thousandths of a pixel's step") {
  std::vector<VertexOutput<4>> floor = slanted_floor();
  // Wholly in view: where Mesa's drivers clip, they can lose linear varyings.
  for (auto& vertex : floor) vertex.position.x *= 0.75f;
  for (auto& vertex : floor) vertex.position.y *= 0.75f;
  for (const auto stage_is_linear : {false, true}) {
    const auto drawn = [&](std::string_view name) {
      return stage_is_linear
                 ? draw_four(floor, GiveFour<kLinear, Give::values>{}, profile_named(name))
                 : draw_four(floor, GiveFour<kPerspective, Give::values>{}, profile_named(name));
    };
    const Image exact = drawn("ieee");
    for (const std::string_view name : {"llvmpipe", "llvmpipe-sse41", "softpipe"}) {
      // Values up to 11 that change by up to 1 a pixel; snapping moves them by 1/512 pixel.
      CHECK_MESSAGE(largest_difference(exact, drawn(name)) < 1.0 / 256.0, name);
    }
  }
}

TEST_CASE("varyings of all kinds are the same whether the guard band clips or not") {
  // The floor reaches far outside of the window; guard bands of 1 and 16 cut it differently.
  std::vector<VertexOutput<4>> vertices = slanted_floor();
  for (auto& vertex : vertices) vertex.position.x *= 4.0f;
  for (auto& vertex : vertices) vertex.position.y *= 3.0f;
  Profile tight = profile_named("ieee");
  tight.guard_band = 1.0f;
  CHECK(largest_difference(draw_four(vertices, GiveFour<kPerspective, Give::values>{}),
                           draw_four(vertices, GiveFour<kPerspective, Give::values>{}, tight)) <
        1e-2);
  CHECK(largest_difference(draw_four(vertices, GiveFour<kLinear, Give::values>{}),
                           draw_four(vertices, GiveFour<kLinear, Give::values>{}, tight)) < 1e-2);
  CHECK(largest_difference(draw_four(vertices, GiveFour<kFlat, Give::values>{}),
                           draw_four(vertices, GiveFour<kFlat, Give::values>{}, tight)) == 0.0);
}

TEST_CASE("derivatives are equal for the four pixels of each 2x2 block, in odd targets too") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    for (const auto give_ddx : {true, false}) {
      const Image target =
          give_ddx
              ? draw_four(slanted_floor(), GiveFour<kPerspective, Give::ddx>{}, profile, 63, 61)
              : draw_four(slanted_floor(), GiveFour<kPerspective, Give::ddy>{}, profile, 63, 61);
      // The two triangles meet on the diagonal: a block that both touch has two planes.
      int wrong = 0;
      int blocks = 0;
      for (int y = 0; y < 61; ++y) {
        for (int x = 0; x < 63; ++x) {
          if (std::fabs(x * 61.0 - y * 63.0) < 400.0) continue;
          ++blocks;
          wrong += !test::same_bits(load_texel(target, x, y), load_texel(target, x & ~1, y & ~1));
        }
      }
      CHECK_MESSAGE(wrong == 0, known.name);
      CHECK(blocks > 2'000);
    }
  }
}

TEST_CASE("derivatives are the differences on the block's upper and left side, softpipe's lower") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    const Image values =
        draw_four(slanted_floor(), GiveFour<kPerspective, Give::values>{}, profile);
    const Image ddx = draw_four(slanted_floor(), GiveFour<kPerspective, Give::ddx>{}, profile);
    const Image ddy = draw_four(slanted_floor(), GiveFour<kPerspective, Give::ddy>{}, profile);
    int wrong = 0;
    for (int y = 0; y < kSize; y += 2) {
      for (int x = 0; x < kSize; x += 2) {
        if (std::abs(x - y) < 4) continue;
        const glm::vec4 corner = load_texel(values, x, y);
        const int row = known.name == "softpipe" ? y + 1 : y;
        const glm::vec4 left = load_texel(values, x, row);
        wrong += load_texel(ddx, x + 1, y) != load_texel(values, x + 1, row) - left;
        wrong += load_texel(ddy, x + 1, y + 1) != load_texel(values, x, y + 1) - corner;
      }
    }
    CHECK_MESSAGE(wrong == 0, known.name);
  }
}

TEST_CASE("derivatives of a flat varying are 0, and of all varyings where a stage does not ask") {
  const Image flat = draw_four(slanted_floor(), GiveFour<kFlat, Give::ddx>{});
  const Image unasked = draw_four(slanted_floor(), GiveFour<kPerspective, Give::ddy, false>{});
  int wrong = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      wrong +=
          load_texel(flat, x, y) != glm::vec4{0.0f} || load_texel(unasked, x, y) != glm::vec4{0.0f};
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("fused and unfused planes differ somewhere, and by rounding only") {
  const auto drawn = [](std::string_view name) {
    return draw_four(slanted_floor(), GiveFour<kPerspective, Give::values>{}, profile_named(name));
  };
  Profile unfused = profile_named("llvmpipe");
  unfused.interpolation = Contraction::unfused;
  const Image plain = draw_four(slanted_floor(), GiveFour<kPerspective, Give::values>{}, unfused);
  CHECK_FALSE(equal(drawn("llvmpipe"), plain));
  CHECK(largest_difference(drawn("llvmpipe"), plain) < 1e-4);
}
