// Clipped triangles in whole draw calls: the order of their parts, on which the bits depend, flat
// values, viewport transform and culling.

#include <doctest/doctest.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "raster/images/texel.h"
#include "raster/pipeline/clip.h"
#include "raster/pipeline/draw.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

TEST_CASE("a flat varying is the last vertex's value, or the first's if it provokes, cut or not") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    for (const float reach : {0.9f, 40.0f}) {  // inside, and beyond any guard band
      const std::vector<VertexOutput<4>> vertices{{{-reach, -reach, 0, 1}, {1, 0, 0, 0}},
                                                  {{reach, -reach, 0, 1}, {2, 0, 0, 0}},
                                                  {{-reach, reach, 0, 1}, {3, 0, 0, 0}}};
      for (const auto provoking : {ProvokingVertex::last, ProvokingVertex::first}) {
        Image target = make_image(Format::r32f, 16, 16);
        DrawState state = test::plain_state();
        state.provoking_vertex = provoking;
        test::draw_list({.colour = {&target}}, state, vertices,
                        test::VaryingColour<Interpolation::flat>{}, profile);
        const float expected = provoking == ProvokingVertex::last ? 3.0f : 1.0f;
        CHECK_MESSAGE(load_texel(target, 4, 4).x == expected, known.name);
        CHECK_MESSAGE(load_texel(target, 10, 2).x == expected, known.name);
      }
    }
  }
}

TEST_CASE("a clipped polygon is drawn as a fan about its first vertex, which provokes") {
  // The fan's triangles, drawn as they are, must give the same bits: planes depend on the
  // order of the vertices.
  constexpr std::array kKinds{Interpolation::perspective, Interpolation::perspective,
                              Interpolation::perspective, Interpolation::perspective};
  constexpr int kSide = 64;
  Profile clipping = profile_named("llvmpipe-sse41");
  Profile scissoring = clipping;
  scissoring.guard_band = 16.0f;
  test::Random random{97};
  int different = 0;
  int fans = 0;
  for (int t = 0; t < 400; ++t) {
    std::vector<VertexOutput<4>> corners;
    ClipPolygon polygon;
    polygon.count = 3;
    unsigned planes = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const float w = random.between(0.5f, 3.0f);
      const glm::vec4 p{random.between(-2.0f, 2.0f) * w, random.between(-2.0f, 2.0f) * w,
                        random.between(-0.9f, 0.9f) * w, w};
      corners.push_back({p,
                         {random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f),
                          random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f)}});
      polygon.vertices[i].position = p;
      std::copy_n(corners[i].varyings.begin(), 4, polygon.vertices[i].varyings.begin());
      planes |= clip_code(p, clipping.guard_band);
    }
    if (planes == 0) continue;
    clip_polygon(polygon, planes, kKinds, clipping);
    fans += polygon.count > 4;
    for (const auto provoking : {ProvokingVertex::last, ProvokingVertex::first}) {
      std::vector<VertexOutput<4>> fan;
      for (std::size_t i = 2; i < polygon.count; ++i) {
        const auto order = provoking == ProvokingVertex::last
                               ? std::array{i - 1, i, std::size_t{0}}
                               : std::array{std::size_t{0}, i - 1, i};
        for (const std::size_t k : order) {
          const ClipVertex& v = polygon.vertices[k];
          fan.push_back({v.position, {v.varyings[0], v.varyings[1], v.varyings[2], v.varyings[3]}});
        }
      }
      DrawState state = test::plain_state();
      state.provoking_vertex = provoking;
      const auto drawn = [&](const std::vector<VertexOutput<4>>& list, const Profile& profile) {
        Image target = make_image(Format::rgba32f, kSide, kSide);
        test::draw_list({.colour = {&target}}, state, list,
                        test::VaryingColour<Interpolation::perspective>{}, profile);
        return target;
      };
      different += !equal(drawn(corners, clipping), drawn(fan, scissoring));
    }
  }
  CHECK(different == 0);
  CHECK(fans > 50);
}

TEST_CASE("the viewport transform is fused for vertices that were given, not for those cut") {
  Profile fused = profile_named("llvmpipe");
  Profile unfused = fused;
  unfused.viewport = Contraction::unfused;
  test::Random random{98};
  int cut_differ = 0;
  int given_differ = 0;
  for (int t = 0; t < 200; ++t) {
    std::vector<VertexOutput<4>> given;
    std::vector<VertexOutput<4>> cut;
    for (int i = 0; i < 3; ++i) {
      const float w = random.between(0.5f, 3.0f);
      const float x = random.between(-0.9f, 0.9f) * w;
      const float y = random.between(-0.9f, 0.9f) * w;
      const Varyings<4> varyings{x, y, random.between(0.0f, 1.0f), w};
      given.push_back({{x, y, 0.0f, w}, varyings});
      // Corners all beyond the picture's edges, about its middle.
      const std::array<glm::vec2, 3> far{{{-5.0f, -4.0f}, {6.0f, -3.0f}, {0.5f, 7.0f}}};
      const auto k = static_cast<std::size_t>(i);
      cut.push_back({{far[k].x * w + x, far[k].y * w + y, 0.0f, w}, varyings});
    }
    const auto drawn = [&](const std::vector<VertexOutput<4>>& list, const Profile& profile) {
      Image target = make_image(Format::rgba32f, 61, 47);
      test::draw_list({.colour = {&target}}, test::plain_state(), list,
                      test::VaryingColour<Interpolation::perspective>{}, profile);
      return target;
    };
    given_differ += !equal(drawn(given, fused), drawn(given, unfused));
    cut_differ += !equal(drawn(cut, fused), drawn(cut, unfused));
  }
  CHECK(given_differ > 50);
  CHECK(cut_differ == 0);
}

TEST_CASE("Mesa's drivers cull by unsnapped positions too if a vertex of the batch is outside") {
  // Counter-clockwise until it is snapped to 1/256 pixel, and then clockwise, over three
  // centres. In 1/8192 pixel.
  const std::array<glm::vec2, 3> sliver{{{20482, 20463}, {86004, 86022}, {55945, 55934}}};
  const std::array<glm::vec2, 3> across{{{-90000, 120000}, {-80000, 120000}, {4000, 130000}}};
  const std::array<glm::vec2, 3> within{{{4000, 120000}, {8000, 120000}, {4000, 130000}}};
  const auto drawn = [&](std::string_view name, std::size_t place, const auto& first) {
    // The sliver in its place among 2,000 triangles.
    std::vector<VertexOutput<0>> vertices;
    for (std::size_t t = 0; t < 2'000; ++t) {
      for (const glm::vec2 p : t == place ? sliver : t == 0 ? first : within) {
        vertices.push_back({test::at_window(p / 8192.0f, 16, 16), {}});
      }
    }
    Image target = make_image(Format::r32f, 16, 16);
    DrawState state = test::plain_state();
    state.cull = Cull::back;
    state.front_face = FrontFace::clockwise;
    test::draw_list({.colour = {&target}}, state, vertices, test::OneColour{}, profile_named(name));
    int pixels = 0;
    for (int i = 2; i < 11; ++i) pixels += load_texel(target, i, i).x != 0.0f;
    return pixels;
  };
  for (const std::string_view name : {"llvmpipe", "llvmpipe-sse41"}) {
    CHECK(drawn(name, 1, within) == 3);
    CHECK(drawn(name, 1, across) == 0);
    CHECK(drawn(name, 340, across) == 0);
    CHECK(drawn(name, 341, across) == 3);
  }
  CHECK(drawn("ieee", 1, across) == 3);
}
