// Whole draw calls: order, several targets, threads, and what must draw nothing.

#include "raster/pipeline/draw.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/hash.h"
#include "raster/pipeline/draw_call.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr BlendEquation kOver{BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha,
                              BlendOp::add};

bool all_zero(const Image& image) {
  return std::all_of(image.bytes.begin(), image.bytes.end(),
                     [](std::byte b) { return b == std::byte{0}; });
}

DrawState over_state() {
  DrawState state = test::plain_state();
  state.colour[0].blend = BlendState{kOver, kOver};
  return state;
}

// Three targets: the colour, its half, and its place.
struct ThreeTargets {
  static constexpr std::array<Interpolation, 0> kInterpolation{};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<3> operator()(const Fragment<0>& f) const {
    return {{glm::vec4{0.75f}, glm::vec4{0.375f},
             glm::vec4{static_cast<float>(f.x), static_cast<float>(f.y), f.depth, 1.0f}},
            false};
  }
};

struct CountingVertices {
  const std::vector<VertexOutput<0>>* list;
  std::vector<std::atomic<int>>* calls;
  VertexOutput<0> operator()(std::uint32_t i) const {
    ++(*calls)[i];
    return (*list)[i];
  }
};

struct CountingFragments {
  static constexpr std::array<Interpolation, 0> kInterpolation{};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  std::atomic<int>* calls;
  FragmentOutput<1> operator()(const Fragment<0>&) const {
    ++*calls;
    return {{glm::vec4{1.0f}}, false};
  }
};

// A scene that needs every part at once: thousands of large and small triangles over many
// tiles and chunks, through the clip planes, blended, depth and stencil tested.
struct BusyScene {
  std::vector<VertexOutput<4>> solid;
  std::vector<VertexOutput<4>> glass;

  explicit BusyScene(std::uint64_t seed) {
    test::Random random{seed};
    const auto add = [&](std::vector<VertexOutput<4>>& list, float size) {
      const glm::vec4 centre{random.between(-1.3f, 1.3f), random.between(-1.3f, 1.3f),
                             random.between(-1.1f, 1.1f), 1.0f};
      for (int i = 0; i < 3; ++i) {
        glm::vec4 p = centre;
        for (int k = 0; k < 3; ++k) p[k] += random.between(-size, size);
        list.push_back({p * random.between(0.3f, 4.0f),
                        {random.between(0.0f, 1.0f), random.between(0.0f, 1.0f),
                         random.between(0.0f, 1.0f), random.between(0.1f, 0.9f)}});
      }
    };
    for (int i = 0; i < 1'500; ++i) add(solid, i % 40 == 0 ? 3.0f : 0.15f);
    for (int i = 0; i < 3'000; ++i) add(glass, i % 100 == 0 ? 30.0f : 0.2f);
  }

  // Hash of colour, depth and stencil together.
  std::uint64_t draw_hash(int threads, const Profile& profile,
                          Format format = Format::rgba16f) const {
    Image colour = make_image(format, 203, 149);
    Image depth = make_image(Format::r32f, 203, 149);
    Image stencil = make_image(Format::r8, 203, 149);
    clear_image(depth, glm::vec4{1.0f}, profile);
    const std::vector<std::uint32_t> solid_indices = test::indices_up_to(solid.size());
    const std::vector<std::uint32_t> glass_indices = test::indices_up_to(glass.size());

    DrawState opaque;
    opaque.cull = Cull::back;
    opaque.stencil.emplace();
    opaque.stencil->front.on_pass = StencilOp::increment_wrap;
    DrawState see_through = over_state();
    see_through.depth = DepthState{Compare::less_equal, false};
    see_through.stencil.emplace();
    see_through.stencil->front.on_depth_fail = StencilOp::invert;
    see_through.stencil->back.on_pass = StencilOp::decrement_wrap;
    see_through.scissor = Rectangle{3, 2, 190, 149};

    ThreadPool pool{threads};
    RenderPass pass{.targets = {.colour = {&colour}, .depth = &depth, .stencil = &stencil},
                    .profile = profile,
                    .draws = {}};
    draw(pass, opaque, solid_indices, static_cast<std::uint32_t>(solid.size()),
         test::ListedVertices<4>{&solid}, test::VaryingColour<Interpolation::perspective>{});
    draw(pass, see_through, glass_indices, static_cast<std::uint32_t>(glass.size()),
         test::ListedVertices<4>{&glass}, test::VaryingColour<Interpolation::linear>{});
    draw(pass, opaque, solid_indices, static_cast<std::uint32_t>(solid.size()),
         test::ListedVertices<4>{&solid}, test::VaryingColour<Interpolation::flat>{});
    finish(pass, pool);

    Hash hash;
    for (const Image* image : {&colour, &depth, &stencil}) add_to_hash(hash, hash_image(*image));
    return hash.value;
  }
};

}  // namespace

TEST_CASE(
    "blended triangles merge in the order of submission, across chunks, draws, tiles and threads" *
    doctest::test_suite("threads")) {
  // Two draws of 3,000 translucent triangles, each over four tiles at least, against the
  // same sums taken one by one.
  test::Random random{91};
  const int size = 130;
  std::vector<VertexOutput<4>> vertices;
  glm::vec4 expected{0.0f};
  for (int i = 0; i < 6'000; ++i) {
    const glm::vec4 colour{random.between(0.0f, 1.0f), random.between(0.0f, 1.0f),
                           random.between(0.0f, 1.0f), random.between(0.05f, 0.5f)};
    for (const glm::vec2 p : {glm::vec2{-300.0f, -300.0f}, {600.0f, -300.0f}, {-300.0f, 600.0f}}) {
      vertices.push_back(
          {test::at_window(p, size, size), {colour.x, colour.y, colour.z, colour.w}});
    }
    for (int k = 0; k < 4; ++k) {
      const float source = colour[k] * colour.w;
      const float destination = expected[k] * (1.0f - colour.w);
      expected[k] = source + destination;
    }
  }
  static_assert(3'000 > 2 * kChunkTriangles);
  // The triangle's hypotenuse passes the target by; every pixel sees all 6,000.
  Image target = make_image(Format::rgba32f, size, size);
  const auto indices = test::indices_up_to(vertices.size());
  const std::span<const std::uint32_t> all{indices};
  RenderPass pass{.targets = {.colour = {&target}}, .profile = {}, .draws = {}};
  for (const auto part : {all.first(all.size() / 2), all.last(all.size() / 2)}) {
    draw(pass, over_state(), part, static_cast<std::uint32_t>(vertices.size()),
         test::ListedVertices<4>{&vertices}, test::VaryingColour<Interpolation::flat>{});
  }
  // Only a few pixels of each tile: 6,000 blends each are slow without optimisation.
  static const ScalarSteps whole = *pass.draws[0].scalar_steps;
  ScalarSteps corners = whole;
  corners.shade_tile = [](const void* recorded, std::uint32_t chunk, std::span<const Bin> bins,
                          const Rectangle& tile) {
    whole.shade_tile(recorded, chunk, bins,
                     {tile.x_end - 2, tile.y_end - 2, tile.x_end, tile.y_end});
  };
  for (DrawCall& call : pass.draws) call.scalar_steps = &corners;
  ThreadPool pool{2};
  finish(pass, pool);
  for (const int y : {62, 63, 126, 127, 129}) {
    for (const int x : {62, 63, 126, 127, 128}) CHECK(load_texel(target, x, y) == expected);
  }
}

TEST_CASE("a busy scene gives the same image for 1, 2, 3 and 8 threads, in every profile" *
          doctest::test_suite("threads")) {
  const BusyScene scene{92};
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    const std::uint64_t one = scene.draw_hash(1, profile);
    for (const int threads : {2, 3, 8}) {
      CHECK_MESSAGE(scene.draw_hash(threads, profile) == one, known.name);
    }
  }
}

TEST_CASE("a busy scene gives the same bits in every build, with 3 threads" *
          doctest::test_suite("threads")) {
  struct Golden {
    std::string_view profile;
    Format format;
    std::uint64_t hash;
  };
  const BusyScene scene{93};
  for (const Golden& golden : {Golden{"ieee", Format::rgba16f, 3607297303131756481u},
                               Golden{"ieee", Format::srgb8, 9611053986229089058u},
                               Golden{"d3d11", Format::rgba16f, 1511457697826015019u},
                               Golden{"llvmpipe", Format::rgba16f, 14055340906162920645u},
                               Golden{"llvmpipe-sse41", Format::rgba16f, 6714303225602842345u},
                               Golden{"softpipe", Format::rgba16f, 3391932727514683366u}}) {
    const std::uint64_t hash = scene.draw_hash(3, profile_named(golden.profile), golden.format);
    CHECK_MESSAGE(hash == golden.hash, golden.profile);
  }
}

TEST_CASE("one pass may be used for one frame after another, on the same threads" *
          doctest::test_suite("threads")) {
  const std::vector<VertexOutput<0>> vertices = test::covering_quad(70, 70);
  const auto indices = test::indices_up_to(vertices.size());
  Image target = make_image(Format::r32f, 70, 70);
  ThreadPool pool{3};
  RenderPass pass{.targets = {.colour = {&target}}, .profile = {}, .draws = {}};
  for (int frame = 0; frame < 20; ++frame) {
    draw(pass, test::adding_state(), indices, static_cast<std::uint32_t>(vertices.size()),
         test::ListedVertices<0>{&vertices}, test::OneColour{});
    finish(pass, pool);
  }
  CHECK(load_texel(target, 69, 69).x == 20.0f);
}

TEST_CASE("a pass without draws, and a draw without triangles, leave the targets alone") {
  Image target = make_image(Format::rgba16f, 70, 70);
  ThreadPool pool{2};
  RenderPass pass{.targets = {.colour = {&target}}, .profile = {}, .draws = {}};
  finish(pass, pool);
  const std::vector<VertexOutput<0>> none;
  draw(pass, test::plain_state(), {}, 0, test::ListedVertices<0>{&none}, test::OneColour{});
  finish(pass, pool);
  CHECK(all_zero(target));
}

TEST_CASE("the vertex stage runs once a vertex, however often indices name it, on any thread" *
          doctest::test_suite("threads")) {
  std::vector<VertexOutput<0>> vertices(5'000, VertexOutput<0>{{0.0f, 0.0f, 0.0f, 1.0f}, {}});
  std::vector<std::atomic<int>> calls(vertices.size());
  const std::vector<std::uint32_t> indices(300, 7u);
  Image target = make_image(Format::r8, 4, 4);
  ThreadPool pool{4};
  RenderPass pass{.targets = {.colour = {&target}}, .profile = {}, .draws = {}};
  draw(pass, test::plain_state(), indices, 5'000u, CountingVertices{&vertices, &calls},
       test::OneColour{});
  finish(pass, pool);
  CHECK(std::all_of(calls.begin(), calls.end(), [](const auto& count) { return count == 1; }));
}

TEST_CASE("the fragment stage runs once for each pixel that passes the early test, on any thread" *
          doctest::test_suite("threads")) {
  Image target = make_image(Format::r8, 100, 100);
  Image depth = make_image(Format::r32f, 100, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x)
      row<float>(depth, y)[static_cast<std::size_t>(x)] = x < 30 ? 0.0f : 1.0f;
  }
  std::atomic<int> calls{0};
  DrawState state;
  state.cull = Cull::none;
  test::draw_list({.colour = {&target}, .depth = &depth}, state, test::covering_quad(100, 100),
                  CountingFragments{&calls}, {}, 3);
  CHECK(calls == 70 * 100);
}

TEST_CASE("indices choose the vertices") {
  const std::vector<VertexOutput<0>> vertices = test::window_triangles(
      std::array<glm::vec2, 6>{{{100, 100}, {0, 0}, {100, 101}, {32, 0}, {101, 100}, {0, 32}}}, 16,
      16);
  const std::vector<std::uint32_t> indices{1, 3, 5};
  Image target = make_image(Format::r32f, 16, 16);
  ThreadPool pool{1};
  RenderPass pass{.targets = {.colour = {&target}}, .profile = {}, .draws = {}};
  draw(pass, test::plain_state(), indices, 6, test::ListedVertices<0>{&vertices},
       test::OneColour{});
  finish(pass, pool);
  CHECK(load_texel(target, 0, 0).x == 1.0f);
  CHECK(load_texel(target, 15, 15).x == 1.0f);
}

TEST_CASE("several colour targets of different formats and states get their own colours") {
  Image half = make_image(Format::rgba16f, 9, 9);
  Image bytes = make_image(Format::rgba8, 9, 9);
  Image place = make_image(Format::rgba32f, 9, 9);
  clear_image(bytes, glm::vec4{0.25f}, {});
  DrawState state = test::plain_state();
  const BlendEquation add{BlendFactor::one, BlendFactor::one, BlendOp::add};
  state.colour[1].blend = BlendState{add, add};
  state.colour[2].write = {true, true, true, false};
  test::draw_list({.colour = {&half, &bytes, &place}}, state, test::covering_quad(9, 9),
                  ThreeTargets{});
  int wrong = 0;
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      wrong += load_texel(half, x, y) != glm::vec4{0.75f};
      wrong += row<std::uint8_t>(bytes, y)[static_cast<std::size_t>(4 * x)] !=
               160;  // (64/255 + 0.375) * 255
      wrong += load_texel(place, x, y) !=
               glm::vec4{static_cast<float>(x), static_cast<float>(y), 0.5f, 0.0f};
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a colour target that is not there is passed over") {
  Image place = make_image(Format::rgba32f, 9, 9);
  test::draw_list({.colour = {nullptr, nullptr, &place}}, test::plain_state(),
                  test::covering_quad(9, 9), ThreeTargets{});
  CHECK(load_texel(place, 8, 7) == glm::vec4{8.0f, 7.0f, 0.5f, 1.0f});
}

TEST_CASE("a depth buffer alone can be drawn into") {
  Image depth = make_image(Format::r32f, 9, 9);
  clear_image(depth, glm::vec4{1.0f}, {});
  DrawState state;
  state.cull = Cull::none;
  test::draw_list({.depth = &depth}, state, test::covering_quad(9, 9, 0.25f), test::OneColour{});
  CHECK(load_texel(depth, 4, 4).x == 0.25f);
}

TEST_CASE("a triangle with a NaN or infinite position draws nothing, its neighbours draw") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    for (int component = 0; component < 4; ++component) {
      for (const float odd : {kNan, kInfinity, -kInfinity}) {
        std::vector<VertexOutput<0>> vertices = test::covering_quad(16, 16);
        vertices[4].position[component] = odd;  // of the second triangle, lower left
        Image target = make_image(Format::r32f, 16, 16);
        test::draw_list({.colour = {&target}}, test::plain_state(), vertices, test::OneColour{},
                        profile);
        CHECK(load_texel(target, 12, 3).x == 1.0f);
        CHECK(load_texel(target, 3, 12).x == 0.0f);
      }
    }
  }
}

TEST_CASE("a triangle whose vertices all have w = 0 draws nothing") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    const std::vector<VertexOutput<0>> vertices{{{-1, -1, 0, 0}, {}}, {{3, -1, 0, 0}, {}},
                                                {{-1, 3, 0, 0}, {}},  {{0, 0, 0, 0}, {}},
                                                {{0, 0, 0, 0}, {}},   {{0, 0, 0, 0}, {}}};
    Image target = make_image(Format::r32f, 16, 16);
    test::draw_list({.colour = {&target}}, test::plain_state(), vertices, test::OneColour{},
                    profile);
    CHECK(all_zero(target));
  }
}

TEST_CASE("a triangle with one vertex in the plane of the eye (w = 0) draws the part before it") {
  // A floor that runs to the eye: y = 1, from w = 0 to w = 8, seen below the horizon only.
  const auto at = [](float x, float w) {
    return VertexOutput<0>{{x, 1.0f, (8.1f * w - 1.6f) / 7.9f, w}, {}};
  };
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    Image target = make_image(Format::r32f, 32, 32);
    test::draw_list({.colour = {&target}}, test::adding_state(),
                    std::vector{at(0, 0), at(-9, 8), at(9, 8)}, test::OneColour{}, profile);
    int above = 0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 32; ++x) above += load_texel(target, x, y).x != 0.0f;
    }
    CHECK(above == 0);
    CHECK(load_texel(target, 16, 30).x == 1.0f);
  }
}

TEST_CASE("a triangle behind the eye or beyond the far plane draws nothing") {
  for (const float w : {-1.0f, 1.0f}) {
    const float z = w < 0.0f ? 0.0f : 1.5f;
    const std::vector<VertexOutput<0>> vertices{
        {{-1, -1, z, w}, {}}, {{3, -1, z, w}, {}}, {{-1, 3, z, w}, {}}};
    Image target = make_image(Format::r32f, 16, 16);
    test::draw_list({.colour = {&target}}, test::plain_state(), vertices, test::OneColour{});
    CHECK(all_zero(target));
  }
}

TEST_CASE("positions at random over the whole range of floats draw without harm") {
  test::Random random{94};
  std::vector<VertexOutput<4>> vertices;
  for (int i = 0; i < 3 * 3'000; ++i) {
    glm::vec4 p{};
    for (int k = 0; k < 4; ++k) {
      p[k] = random.whole(0, 1) == 0
                 ? std::bit_cast<float>(static_cast<std::uint32_t>(random.next()))
                 : std::ldexp(random.between(-1.0f, 1.0f), random.whole(-3, 3));
    }
    vertices.push_back({p, {random.between(-1.0f, 1.0f), kNan, kInfinity, 1e38f}});
  }
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    Image target = make_image(Format::rgba16f, 40, 40);
    Image depth = make_image(Format::r32f, 40, 40);
    clear_image(depth, glm::vec4{1.0f}, {});
    DrawState state = over_state();
    state.depth = DepthState{Compare::less, true};
    test::draw_list({.colour = {&target}, .depth = &depth}, state, vertices,
                    test::VaryingColour<Interpolation::perspective>{}, profile, 2);
    int outside = 0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) {
        const float d = load_texel(depth, x, y).x;
        outside += !(d >= 0.0f && d <= 1.0f);
      }
    }
    CHECK_MESSAGE(outside == 0, known.name);
  }
}

TEST_CASE("an exception in a fragment stage on any thread reaches the caller of finish" *
          doctest::test_suite("threads")) {
  struct Thrower {
    int unused = 0;
  };
  const std::vector<VertexOutput<0>> vertices = test::covering_quad(200, 200);
  const auto indices = test::indices_up_to(vertices.size());
  Image target = make_image(Format::r8, 200, 200);
  ThreadPool pool{3};
  RenderPass pass{.targets = {.colour = {&target}}, .profile = {}, .draws = {}};
  draw(pass, test::plain_state(), indices, 6, test::ListedVertices<0>{&vertices},
       test::OneColour{});
  ScalarSteps throwing = *pass.draws[0].scalar_steps;
  throwing.shade_tile = [](const void*, std::uint32_t, std::span<const Bin>, const Rectangle&) {
    throw Thrower{};
  };
  pass.draws[0].scalar_steps = &throwing;
  CHECK_THROWS_AS(finish(pass, pool), Thrower);
}

TEST_CASE("the targets' size is that of any of them") {
  Image colour = make_image(Format::rgba8, 5, 7);
  Image depth = make_image(Format::r32f, 5, 7);
  Image stencil = make_image(Format::r8, 5, 7);
  for (const RenderTargets& targets :
       {RenderTargets{.colour = {&colour}},
        {.depth = &depth},
        {.stencil = &stencil},
        {.colour = {nullptr, nullptr, nullptr, &colour}},
        {.colour = {&colour}, .depth = &depth, .stencil = &stencil}}) {
    const Rectangle area = target_area(targets);
    CHECK(area.x_begin == 0);
    CHECK(area.y_begin == 0);
    CHECK(area.x_end == 5);
    CHECK(area.y_end == 7);
  }
}
