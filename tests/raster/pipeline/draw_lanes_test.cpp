// Drawing in vector lanes against drawing fragment by fragment: the same bits.

#ifndef SOFTFOCUS_ISA

#include "raster/pipeline/lanes/draw_in_lanes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/multisample.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/sanitizers.h"

namespace softfocus {

// Every kind of varying, and differences of them.
struct MixedColour {
  static constexpr std::array kInterpolation{Interpolation::perspective, Interpolation::linear,
                                             Interpolation::perspective, Interpolation::flat};
  static constexpr bool kNeedsDerivatives = true;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<4>& in) const {
    const float side = in.front_facing ? in.varyings[2] : -in.varyings[2];
    return {{glm::vec4{in.varyings[0] + in.ddx[0], in.varyings[1] - in.ddy[0], side,
                       in.varyings[3] + in.ddx[1]}},
            false};
  }
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "tests/raster/pipeline/draw_lanes_test.cpp"
#include "raster/lanes/for_each_isa.inl"

using namespace softfocus;
using test::profile_named;

namespace {

using Vertices = std::vector<VertexOutput<4>>;

struct Drawn {
  Image colour;
  Image depth;
};

struct Target {
  int width;
  int height;
  int samples = 1;
};

LaneStages<test::ListedVertices<4>, MixedColour> stages_for(Isa isa) {
  return {SOFTFOCUS_KERNEL(isa, place_listed), SOFTFOCUS_KERNEL(isa, shade_listed),
          SOFTFOCUS_KERNEL(isa, shade_mixed)};
}

Drawn draw_mixed(Isa isa, const Target& target, const DrawState& state, const Vertices& vertices,
                 const Profile& profile, int threads = 1) {
  const int rows = target.height * target.samples;
  Drawn drawn{make_image(Format::rgba16f, target.width, rows),
              make_image(Format::r32f, target.width, rows)};
  RenderPass pass;
  pass.targets.samples = target.samples;
  pass.targets.colour[0] = &drawn.colour;
  pass.targets.depth = &drawn.depth;
  pass.profile = profile;
  pass.isa = isa;
  pass.clear_colour = glm::vec4{0.25f};
  pass.clear_depth = 0.75f;
  const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
  const auto count = static_cast<std::uint32_t>(vertices.size());
  const test::ListedVertices<4> vertex_stage{&vertices};
  ThreadPool pool{threads, isa};
  if (isa == Isa::scalar) {
    draw(pass, state, indices, count, vertex_stage, MixedColour{});
  } else {
    REQUIRE(can_draw_in_lanes(pass, state));
    draw_in_lanes(pass, state, indices, count, vertex_stage, MixedColour{}, stages_for(isa));
  }
  finish(pass, pool);
  return drawn;
}

// Triangles about points in the window, of edges up to `size` pixels.
Vertices random_triangles(test::Random& random, const Target& target, int count, double size) {
  Vertices vertices;
  for (int t = 0; t < count; ++t) {
    const double x = random.between(-8.0, target.width + 8.0);
    const double y = random.between(-8.0, target.height + 8.0);
    for (int i = 0; i < 3; ++i) {
      const glm::vec2 window{static_cast<float>(x + random.between(-size, size)),
                             static_cast<float>(y + random.between(-size, size))};
      VertexOutput<4> vertex{
          test::at_window(window, target.width, target.height, random.between(-0.9f, 0.9f)), {}};
      vertex.position *= random.between(0.2f, 3.0f);
      for (float& value : vertex.varyings) value = random.between(-2.0f, 2.0f);
      vertices.push_back(vertex);
    }
  }
  return vertices;
}

void check_all_isas(Target target, const DrawState& state, const Vertices& vertices,
                    const Profile& profile, const std::vector<int>& sample_counts = {1, 4}) {
  for (const int samples : sample_counts) {
    if (target.height * samples > kMaxImageSize) continue;
    target.samples = samples;
    const Drawn expected = draw_mixed(Isa::scalar, target, state, vertices, profile);
    for (const Isa isa : available_isas()) {
      if (isa == Isa::scalar) continue;
      const Drawn drawn = draw_mixed(isa, target, state, vertices, profile);
      INFO("isa ", isa_name(isa));
      INFO("samples ", samples);
      CHECK(equal(drawn.colour, expected.colour));
      CHECK(equal(drawn.depth, expected.depth));
    }
  }
}

RenderPass pass_into(Image& colour, Image& depth, Isa isa) {
  RenderPass pass;
  pass.targets.colour[0] = &colour;
  pass.targets.depth = &depth;
  pass.isa = isa;
  return pass;
}

// --- edges, one pixel after the other ---

struct Edges {
  Image picture, depth, other, coverage;
};

Edges no_edges(const Target& target) {
  Edges edges{make_image(Format::rgba16f, target.width, target.height),
              make_image(Format::r32f, target.width, target.height),
              make_image(Format::rgba16f, target.width, target.height),
              make_image(Format::r8, target.width, target.height)};
  clear_image(edges.coverage, glm::vec4{1.0f}, {});  // what is not written shows
  return edges;
}

constexpr glm::vec4 kEdgesClear{0.25f};
constexpr float kEdgesDepth = 0.75f;

Edges draw_edges(Isa isa, const Target& target, int samples, const Vertices& vertices,
                 std::span<const std::uint32_t> indices, const Profile& profile,
                 std::size_t layers = 1) {
  Edges edges = no_edges(target);
  std::vector<Image> colours, depths;
  for (std::size_t i = 1; i < layers; ++i) {
    colours.push_back(make_image(Format::rgba16f, target.width, target.height));
    depths.push_back(make_image(Format::r32f, target.width, target.height));
  }
  RenderPass pass = pass_into(edges.picture, edges.depth, isa);
  for (std::size_t i = 1; i < layers; ++i) {
    pass.targets.behind[i - 1] = {&colours[i - 1], &depths[i - 1]};
  }
  pass.profile = profile;
  if (samples > 1) pass.edges = {samples, &edges.other, &edges.coverage};
  pass.clear_colour = kEdgesClear;
  pass.clear_depth = kEdgesDepth;
  DrawState state;
  state.cull = Cull::none;
  draw_in_lanes(pass, state, indices, static_cast<std::uint32_t>(vertices.size()),
                test::ListedVertices<4>{&vertices}, MixedColour{}, stages_for(isa));
  ThreadPool pool{2, isa};
  finish(pass, pool);
  return edges;
}

struct PlacedTriangle {
  Triangle<4> triangle;
  std::array<std::uint32_t, 3> corners;
};

// Of triangles that nothing clips.
std::vector<PlacedTriangle> place_triangles(const Target& target, int samples,
                                            const Vertices& vertices,
                                            std::span<const std::uint32_t> indices,
                                            const Profile& profile) {
  std::vector<PlacedTriangle> placed;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    std::array<WindowVertex, 3> window{};
    std::array<Varyings<4>, 3> varyings{};
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexOutput<4>& vertex = vertices[indices[i + k]];
      window[k] = to_window(vertex.position, target.width, target.height, profile.viewport);
      varyings[k] = vertex.varyings;
    }
    const auto setup = set_up_triangle(window, Cull::none, FrontFace::counter_clockwise,
                                       {0, 0, target.width, target.height}, profile, 1, samples);
    if (!setup) continue;
    placed.push_back({{*setup, varyings, 2}, {indices[i], indices[i + 1], indices[i + 2]}});
  }
  return placed;
}

bool covers(const PlacedTriangle& placed, int x, int y, const glm::ivec2& place) {
  const auto& functions = std::get<EdgeFunctions>(placed.triangle.setup.coverage);
  return std::all_of(functions.edges.begin(), functions.edges.end(), [&](const EdgeFunction& edge) {
    return inside(edge, edge_at(edge, x, y, place));
  });
}

bool share_surface(const PlacedTriangle& a, const PlacedTriangle& b) {
  if (a.triangle.setup.front_facing != b.triangle.setup.front_facing) return false;
  return std::any_of(a.corners.begin(), a.corners.end(), [&](std::uint32_t corner) {
    return std::find(b.corners.begin(), b.corners.end(), corner) != b.corners.end();
  });
}

template <class Interpolator>
glm::vec4 shaded(const PlacedTriangle& placed, int x, int y, const glm::ivec2& place,
                 const Profile& profile) {
  const Interpolator interpolator{placed.triangle, profile, MixedColour::kInterpolation};
  Fragment<4> fragment{.x = x, .y = y, .front_facing = placed.triangle.setup.front_facing};
  fragment.varyings = interpolator.at(x, y, place).varyings;
  // Differences of the quad, at the same places of its pixels.
  const Varyings<4> corner = interpolator.at(x & ~1, y & ~1, place).varyings;
  const Varyings<4> right = interpolator.at(x | 1, y & ~1, place).varyings;
  const Varyings<4> below = interpolator.at(x & ~1, y | 1, place).varyings;
  for (std::size_t i = 0; i < 4; ++i) {
    fragment.ddx[i] = right[i] - corner[i];
    fragment.ddy[i] = below[i] - corner[i];
  }
  Image texel = make_image(Format::rgba16f, 1, 1);
  store_texel(texel, 0, 0, MixedColour{}(fragment).colour[0], profile);
  return load_texel(texel, 0, 0);
}

template <class Interpolator>
void store_edge(const Image& picture, Edges& to, int samples,
                std::span<const PlacedTriangle> triangles, int x, int y, const Profile& profile) {
  const std::span<const glm::ivec2> places = sample_places(samples);
  const auto shown_at = [&](const glm::ivec2& place) {
    const PlacedTriangle* shown = nullptr;
    float nearest = kEdgesDepth;
    for (const PlacedTriangle& placed : triangles) {
      const Rectangle& bounds = placed.triangle.setup.bounds;
      if (x < bounds.x_begin || x >= bounds.x_end || y < bounds.y_begin || y >= bounds.y_end) {
        continue;
      }
      if (!covers(placed, x, y, place)) continue;
      const Interpolator interpolator{placed.triangle, profile, MixedColour::kInterpolation};
      const float depth =
          draw_detail::clamped_depth(interpolator.depth(interpolator.pixel(x, y, place)), profile);
      if (!(depth < nearest)) continue;
      nearest = depth;
      shown = &placed;
    }
    return shown;
  };
  const auto are_one = [](const PlacedTriangle* a, const PlacedTriangle* b) {
    return a == b || (a != nullptr && b != nullptr && share_surface(*a, *b));
  };
  const PlacedTriangle* centre = shown_at({});
  std::vector<const PlacedTriangle*> shows;
  for (const glm::ivec2& place : places) shows.push_back(shown_at(place));
  std::vector<bool> is_done(places.size());
  std::vector<glm::vec4> texels(places.size()), others;
  for (std::size_t first = 0; first < places.size(); ++first) {
    if (is_done[first] || are_one(centre, shows[first])) continue;
    std::vector<std::size_t> of_surface;
    for (std::size_t s = first; s < places.size(); ++s) {
      if (!is_done[s] && !are_one(centre, shows[s]) && are_one(shows[first], shows[s])) {
        of_surface.push_back(s);
      }
    }
    const PlacedTriangle* by = nullptr;
    glm::ivec2 place{};
    int most = 0;
    for (const std::size_t s : of_surface) {
      int count = 0;
      glm::ivec2 sum{};
      for (const std::size_t other : of_surface) {
        if (shows[other] != shows[s]) continue;
        sum += places[other];
        ++count;
      }
      if (count <= most) continue;
      by = shows[s];
      most = count;
      place = sum / count;
    }
    Image texel = make_image(Format::rgba16f, 1, 1);
    store_texel(texel, 0, 0, kEdgesClear, profile);
    for (const std::size_t s : of_surface) {
      texels[s] =
          by == nullptr ? load_texel(texel, 0, 0) : shaded<Interpolator>(*by, x, y, place, profile);
      is_done[s] = true;
    }
  }
  for (std::size_t s = 0; s < places.size(); ++s) {
    if (is_done[s]) others.push_back(texels[s]);
  }
  const OtherSurface found = other_surface(load_texel(picture, x, y).w, others);
  row<std::uint8_t>(to.coverage, y)[static_cast<std::size_t>(x)] =
      coverage_byte(found.samples, samples);
  if (found.samples > 0) store_texel(to.other, x, y, found.texel, profile);
}

// Returns how many edge pixels there were.
int check_edges(const Target& target, const Vertices& vertices,
                std::span<const std::uint32_t> indices, const Profile& profile) {
  int mixed = 0;
  for (const int samples : {4, 8}) {
    Edges expected = no_edges(target);
    bool is_known = false;
    for (const Isa isa : available_isas()) {
      if (isa == Isa::scalar) continue;
      const Edges without = draw_edges(isa, target, 1, vertices, indices, profile);
      const auto triangles = place_triangles(target, samples, vertices, indices, profile);
      for (int y = 0; y < target.height && !is_known; ++y) {
        for (int x = 0; x < target.width; ++x) {
          if (profile.attributes == AttributeSetup::exact_barycentric) {
            store_edge<BarycentricInterpolator<4>>(without.picture, expected, samples, triangles, x,
                                                   y, profile);
          } else {
            using Interpolator = PlaneInterpolator<PlanesFromOrigin, 4>;
            store_edge<Interpolator>(without.picture, expected, samples, triangles, x, y, profile);
          }
        }
      }
      is_known = true;
      for (const std::size_t layers : {std::size_t{1}, std::size_t{3}}) {
        const Edges drawn = draw_edges(isa, target, samples, vertices, indices, profile, layers);
        INFO("isa ", isa_name(isa));
        INFO("samples ", samples, ", layers ", layers);
        CHECK(equal(drawn.picture, without.picture));
        CHECK(equal(drawn.depth, without.depth));
        CHECK(equal(drawn.coverage, expected.coverage));
        int different = 0;
        for (int y = 0; y < target.height; ++y) {
          for (int x = 0; x < target.width; ++x) {
            if (load_texel(expected.coverage, x, y).x == 0.0f) continue;
            ++mixed;
            different +=
                !test::same_bits(load_texel(drawn.other, x, y), load_texel(expected.other, x, y));
          }
        }
        CHECK(different == 0);
      }
    }
  }
  return mixed;
}

// Sheets of quads that share corners, bent and before each other.
std::pair<Vertices, std::vector<std::uint32_t>> sheets(test::Random& random, const Target& target,
                                                       int sheet_count, int cells,
                                                       std::optional<double> size = {}) {
  Vertices vertices;
  std::vector<std::uint32_t> indices;
  for (int sheet = 0; sheet < sheet_count; ++sheet) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    const double x = random.between(2.0, target.width * 0.6),
                 y = random.between(2.0, target.height * 0.6);
    const double cell = size.value_or(random.between(0.4, 5.0));
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const double from = size ? 0.5 * cells : 0.0;  // a large one lies about its middle
        const glm::vec2 window{
            static_cast<float>(x + cell * (i - from + random.between(-0.6, 0.6))),
            static_cast<float>(y + cell * (j - from + random.between(-0.6, 0.6)))};
        VertexOutput<4> vertex{
            test::at_window(window, target.width, target.height, random.between(-0.9f, 0.9f)), {}};
        vertex.position *= random.between(0.5f, 2.0f);
        for (float& value : vertex.varyings) value = random.between(-2.0f, 2.0f);
        vertices.push_back(vertex);
      }
    }
    const auto across = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t j = 0; j + 1 < across; ++j) {
      for (std::uint32_t i = 0; i + 1 < across; ++i) {
        const std::uint32_t at = first + j * across + i;
        for (const std::uint32_t corner : {0u, 1u, across, across, 1u, across + 1}) {
          indices.push_back(at + corner);
        }
      }
    }
  }
  return {vertices, indices};
}

constexpr std::array kProfileNames{"ieee", "d3d11", "llvmpipe", "llvmpipe-sse41"};
constexpr Target kTarget{150, 97};

}  // namespace

TEST_CASE("lanes: triangles of every size have the scalar form's bits") {
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    test::Random random{501};
    for (const double size : {0.4, 1.5, 6.0, 40.0, 200.0, 3000.0}) {
      check_all_isas(kTarget, {}, random_triangles(random, kTarget, fewer(1500), size),
                     profile_named(name), {1, 4, 8});
    }
  }
}

TEST_CASE("lanes: edges are those that are found pixel by pixel, and leave the picture as it is") {
  const Target target{75, 70};  // four tiles
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    test::Random random{512};
    for (const int cells : {1, 4, 12}) {
      const auto [vertices, indices] = sheets(random, target, fewer(40) / cells + 1, cells);
      CHECK(check_edges(target, vertices, indices, profile_named(name)) > 0);
    }
  }
}

TEST_CASE("lanes: edges of triangles far larger than the picture") {
  const Target target{40, 30};
  test::Random random{513};
  int edges = 0;
  for (const double cell : {95.0, 130.0, 170.0}) {
    const auto [vertices, indices] = sheets(random, target, 6, 2, cell);
    edges += check_edges(target, vertices, indices, {});
  }
  CHECK(edges > 0);
}

TEST_CASE("lanes: triangles as large as the guard band lets them be have the scalar form's bits") {
  test::Random random{511};
  const Target target{kMaxImageSize, 9};
  DrawState state;
  state.cull = Cull::none;
  for (const double size : {60e3, 300e3}) {
    check_all_isas(target, state, random_triangles(random, target, 16, size), {});
  }
}

TEST_CASE("lanes: triangles between the pixels' centres leave no trace") {
  test::Random random{502};
  const Target target{64, 64};
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    DrawState state;
    state.cull = Cull::none;
    check_all_isas(target, state, random_triangles(random, target, fewer(20000), 0.6),
                   profile_named(name));
  }
}

TEST_CASE("lanes: clipping by every plane, and through the eye, is the scalar form's") {
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    test::Random random{503};
    Vertices vertices;
    for (int i = 0; i < 3 * fewer(700); ++i) {
      VertexOutput<4> vertex{};
      for (int k = 0; k < 4; ++k) vertex.position[k] = random.between(-2.0f, 2.0f);
      if (i % 50 == 0) vertex.position.x *= 60.0f;
      for (float& value : vertex.varyings) value = random.between(-2.0f, 2.0f);
      vertices.push_back(vertex);
    }
    DrawState state;
    state.cull = Cull::none;
    check_all_isas(kTarget, state, vertices, profile_named(name));
    state.cull = Cull::front;
    check_all_isas(kTarget, state, vertices, profile_named(name));
  }
}

TEST_CASE("lanes: positions that are no numbers draw what the scalar form draws") {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr std::array kOdd{kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(),
                            0.0f,      -0.0f,      1e-41f,
                            3e38f,     -3e38f};
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    test::Random random{504};
    Vertices vertices = random_triangles(random, kTarget, fewer(900), 20.0);
    for (VertexOutput<4>& vertex : vertices) {
      if (random.whole(0, 3) != 0) continue;
      vertex.position[random.whole(0, 3)] =
          kOdd[static_cast<std::size_t>(random.whole(0, static_cast<int>(kOdd.size()) - 1))];
    }
    check_all_isas(kTarget, {}, vertices, profile_named(name));
  }
}

TEST_CASE("lanes: every depth test, with and without writing") {
  test::Random random{505};
  Vertices vertices = random_triangles(random, kTarget, fewer(400), 30.0);
  // Depths that meet: all of a triangle at one of four.
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i].position.z = (static_cast<float>(i / 3 % 4) * 0.4f - 0.6f) * vertices[i].position.w;
  }
  for (int test = 0; test <= static_cast<int>(Compare::always); ++test) {
    for (const bool write : {true, false}) {
      DrawState state;
      state.depth = DepthState{static_cast<Compare>(test), write};
      for (const char* name : {"ieee", "llvmpipe"}) {
        check_all_isas(kTarget, state, vertices, profile_named(name));
      }
    }
  }
}

TEST_CASE(
    "lanes: depths that rounding takes past the far plane are cut off as in the scalar form") {
  test::Random random{508};
  DrawState state;
  state.cull = Cull::none;
  state.depth = DepthState{Compare::always, true};
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    Vertices vertices = random_triangles(random, kTarget, fewer(3000), 40.0);
    // Two corners, at times three, on the far plane or a hair before it.
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (i % 3 == 0 && i % 2 == 0) continue;
      glm::vec4& position = vertices[i].position;
      position.z = random.whole(0, 1) == 0 ? position.w : std::nextafter(position.w, 0.0f);
    }
    check_all_isas(kTarget, state, vertices, profile_named(name));
  }
}

TEST_CASE("lanes: winding, culling, fill rule and provoking vertex as in the scalar form") {
  test::Random random{506};
  const Vertices vertices = random_triangles(random, kTarget, fewer(600), 12.0);
  for (const char* name : {"ieee", "llvmpipe"}) {
    for (const FillRule rule : {FillRule::upper_left, FillRule::lower_left}) {
      Profile profile = profile_named(name);
      profile.fill_rule = rule;
      for (const int bits : {4, 8}) {
        profile.subpixel_bits = bits;
        for (const Cull cull : {Cull::none, Cull::back, Cull::front}) {
          for (const FrontFace front : {FrontFace::clockwise, FrontFace::counter_clockwise}) {
            for (const auto provoking : {ProvokingVertex::first, ProvokingVertex::last}) {
              DrawState state;
              state.cull = cull;
              state.front_face = front;
              state.provoking_vertex = provoking;
              check_all_isas(kTarget, state, vertices, profile);
            }
          }
        }
      }
    }
  }
}

TEST_CASE("lanes: pictures of every width to 70 pixels") {
  test::Random random{507};
  for (int side = 1; side <= 70; side += 70 / fewer(70)) {
    const Target target{side, 71 - side};
    check_all_isas(target, {}, random_triangles(random, target, 60, 25.0), profile_named("ieee"));
  }
}

TEST_CASE("lanes: threads change nothing" * doctest::test_suite("threads")) {
  test::Random random{508};
  const Target target{300, 200};
  const Vertices vertices = random_triangles(random, target, 5000, 15.0);
  const Drawn expected = draw_mixed(Isa::scalar, target, {}, vertices, {});
  for (const int threads : {2, 3, 7}) {
    const Drawn drawn = draw_mixed(widest_isa(), target, {}, vertices, {}, threads);
    CHECK(equal(drawn.colour, expected.colour));
    CHECK(equal(drawn.depth, expected.depth));
  }
}

TEST_CASE("lanes: a pass mixes draws in lanes with draws that blend") {
  test::Random random{509};
  const Vertices opaque = random_triangles(random, kTarget, 300, 30.0);
  const Vertices over = random_triangles(random, kTarget, 300, 30.0);
  const auto draw_both = [&](Isa isa) {
    Drawn drawn{make_image(Format::rgba16f, kTarget.width, kTarget.height),
                make_image(Format::r32f, kTarget.width, kTarget.height)};
    RenderPass pass;
    pass.targets.colour[0] = &drawn.colour;
    pass.targets.depth = &drawn.depth;
    pass.isa = isa;
    pass.clear_depth = 1.0f;
    const std::vector<std::uint32_t> indices = test::indices_up_to(opaque.size());
    const auto count = static_cast<std::uint32_t>(opaque.size());
    for (int i = 0; i < 2; ++i) {
      const test::ListedVertices<4> solid{i == 0 ? &opaque : &over};
      if (isa == Isa::scalar) {
        draw(pass, {}, indices, count, solid, MixedColour{});
      } else {
        draw_in_lanes(pass, {}, indices, count, solid, MixedColour{}, stages_for(isa));
      }
      DrawState blending = test::adding_state();
      blending.depth = DepthState{};
      CHECK_FALSE(can_draw_in_lanes(pass, blending));
      draw(pass, blending, indices, count, test::ListedVertices<4>{&over}, MixedColour{});
    }
    ThreadPool pool{2, isa};
    finish(pass, pool);
    return drawn;
  };
  const Drawn expected = draw_both(Isa::scalar);
  for (const Isa isa : available_isas()) {
    const Drawn drawn = draw_both(isa);
    CHECK(equal(drawn.colour, expected.colour));
    CHECK(equal(drawn.depth, expected.depth));
  }
}

TEST_CASE("lanes: a vertex is shaded where triangles that are drawn have it, and else left") {
  // Vertex 3 belongs to a triangle that faces away, 4 to none.
  const auto at = [](float x, float y) {
    return VertexOutput<4>{test::at_window({x, y}, 64, 64), {}};
  };
  const Vertices vertices{at(4, 4), at(60, 4), at(60, 60), at(4, 60), at(32, 32)};
  const std::vector<std::uint32_t> indices{0, 2, 1, 0, 2, 3};
  Image colour = make_image(Format::rgba16f, 64, 64), depth = make_image(Format::r32f, 64, 64);
  for (const Isa isa : available_isas()) {
    if (isa == Isa::scalar) continue;
    RenderPass pass = pass_into(colour, depth, isa);
    ThreadPool pool{1, isa};
    for (const bool again : {false, true}) {
      draw_in_lanes(pass, {}, indices, 5, test::ListedVertices<4>{&vertices}, MixedColour{},
                    stages_for(isa));
      TileLists lists;
      if (again) std::memset(pass.memory.rows.get(), 0x7F, 5 * sizeof(CacheLine));
      sort_into_tiles({&pass, 1}, {&lists, 1}, pool);
      for (std::size_t i = 0; again && i < 5; ++i) {
        CHECK((pass.memory.rows[i].floats[kVertexInverseW] == 1.0f) == (i < 3));
      }
      pass.draws.clear();
    }
  }
}

TEST_CASE("lanes: a draw beyond one plane of the view is set aside with its vertices alone") {
  test::Random random{512};
  Vertices beside = random_triangles(random, kTarget, 2000, 4.0);
  for (VertexOutput<4>& vertex : beside) vertex.position.x = -20.0f * vertex.position.w;
  Vertices across = beside;
  across[1000].position.x = 0.0f;
  Image colour = make_image(Format::rgba16f, kTarget.width, kTarget.height);
  Image depth = make_image(Format::r32f, kTarget.width, kTarget.height);
  for (const Isa isa : available_isas()) {
    if (isa == Isa::scalar) continue;
    RenderPass pass = pass_into(colour, depth, isa);
    const std::vector<std::uint32_t> indices = test::indices_up_to(beside.size());
    for (const std::size_t count : {std::size_t{900}, beside.size()}) {
      for (const Vertices* vertices : {&beside, &across}) {
        draw_in_lanes(pass, {}, std::span{indices}.first(count), static_cast<std::uint32_t>(count),
                      test::ListedVertices<4>{vertices}, MixedColour{}, stages_for(isa));
      }
    }
    TileLists lists;
    ThreadPool pool{2, isa};
    sort_into_tiles({&pass, 1}, {&lists, 1}, pool);
    CHECK(pass.draws[0].is_outside);
    CHECK(pass.draws[1].is_outside);  // that vertex is not among its first 900
    CHECK(pass.draws[2].is_outside);
    CHECK(!pass.draws[3].is_outside);
  }
}

TEST_CASE("lanes: a tile drawn aside has the bits that the target would have") {
  test::Random random{513};
  const Vertices vertices = random_triangles(random, kTarget, 400, 30.0);
  const std::vector<std::uint32_t> indices = test::indices_up_to(vertices.size());
  const auto count = static_cast<std::uint32_t>(vertices.size());
  for (const Isa isa : available_isas()) {
    const Drawn expected = draw_mixed(isa, kTarget, {}, vertices, {});
    Drawn drawn{make_image(Format::rgba16f, kTarget.width, kTarget.height),
                make_image(Format::r32f, kTarget.width, kTarget.height)};
    RenderPass pass;
    pass.targets.colour[0] = &drawn.colour;
    pass.targets.depth = &drawn.depth;
    pass.isa = isa;
    pass.clear_colour = glm::vec4{0.25f};
    pass.clear_depth = 0.75f;
    const test::ListedVertices<4> stage{&vertices};
    if (isa == Isa::scalar) {
      draw(pass, {}, indices, count, stage, MixedColour{});
    } else {
      draw_in_lanes(pass, {}, indices, count, stage, MixedColour{}, stages_for(isa));
    }
    TileLists lists;
    ThreadPool pool{1, isa};
    sort_into_tiles({&pass, 1}, {&lists, 1}, pool);
    TileMemory memory;
    for (int tile = 0; tile < tile_count(lists); ++tile) {
      const Rectangle area = tile_area(lists, tile);
      const auto row_bytes = static_cast<std::size_t>(area.x_end - area.x_begin) * 8;
      std::vector<std::byte> texels(row_bytes * kTileSize);
      draw_tile_aside(pass, lists, tile, memory, texels.data());
      bool all_equal = true;
      for (int y = area.y_begin; y < area.y_end; ++y) {
        const auto from = row<std::uint16_t>(expected.colour, y);
        all_equal = all_equal &&
                    std::memcmp(&texels[static_cast<std::size_t>(y - area.y_begin) * row_bytes],
                                &from[4 * static_cast<std::size_t>(area.x_begin)], row_bytes) == 0;
      }
      CHECK(all_equal);
    }
  }
}

#else  // once a vector unit

#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/interpolate_lanes.inl"
#include "raster/pipeline/lanes/shade_lanes.inl"
#include "raster/pipeline/lanes/vertex_lanes.inl"

namespace {

struct ListedLanes {
  static constexpr std::size_t kVaryings = 4;
  const std::vector<VertexOutput<4>>& list;

  void position(Ints index, std::array<Floats, 4>& in_clip_space) const {
    for (int lane = 0; lane < kLanes; ++lane) {
      const VertexOutput<4>& vertex = list[static_cast<std::size_t>(index[lane])];
      for (int i = 0; i < 4; ++i) {
        in_clip_space[static_cast<std::size_t>(i)][lane] = vertex.position[i];
      }
    }
  }
  void operator()(Ints index, std::array<Floats, 4>& in_clip_space,
                  std::array<Floats, 4>& varyings) const {
    position(index, in_clip_space);
    for (int lane = 0; lane < kLanes; ++lane) {
      const VertexOutput<4>& vertex = list[static_cast<std::size_t>(index[lane])];
      for (int i = 0; i < 4; ++i) {
        varyings[static_cast<std::size_t>(i)][lane] = vertex.varyings[static_cast<std::size_t>(i)];
      }
    }
  }
};

struct MixedLanes {
  static constexpr auto kInterpolation = MixedColour::kInterpolation;
  static constexpr std::size_t kInputs = 4;

  template <class Quads, class Put>
  void inputs(const Quads& in, const Put& put) const {
    put(0, in.varying(0) + in.ddx(0));
    put(1, in.varying(1) - in.ddy(0));
    put(2, select(in.front_facing(), in.varying(2), -in.varying(2)));
    put(3, in.varying(3) + in.ddx(1));
  }
  void shade(const FragmentBatch<4>& batch, std::array<Floats, 4>* colours) const {
    for (int i = 0; i < batch.vectors(); ++i) {
      colours[i] = {batch.input(0, i), batch.input(1, i), batch.input(2, i), batch.input(3, i)};
    }
  }
};

}  // namespace

unsigned place_listed(const test::ListedVertices<4>& stage, const VertexJob& job) {
  return place_vertices(ListedLanes{*stage.list}, job);
}

void shade_listed(const test::ListedVertices<4>& stage, const VertexJob& job) {
  shade_vertices(ListedLanes{*stage.list}, job);
}

void shade_mixed(const MixedColour&, const FragmentJob& job, const VisibilityTile& tile,
                 const VisibleRun& run) {
  shade_fragments(MixedLanes{}, job, tile, run);
}

#endif
