// Drawing in vector lanes against drawing fragment by fragment: the same bits.

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
#include "raster/pipeline/draw.h"
#include "raster/pipeline/multisample.h"
#include "tests/support/mixed_stage.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/sanitizers.h"

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
    draw(pass, state, indices, count, vertex_stage, test::MixedColour{});
  } else {
    REQUIRE(can_draw_in_lanes(pass, state));
    draw_in_lanes(pass, state, indices, count, vertex_stage, test::MixedColour{},
                  test::mixed_stages(isa));
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
        draw(pass, {}, indices, count, solid, test::MixedColour{});
      } else {
        draw_in_lanes(pass, {}, indices, count, solid, test::MixedColour{},
                      test::mixed_stages(isa));
      }
      DrawState blending = test::adding_state();
      blending.depth = DepthState{};
      CHECK_FALSE(can_draw_in_lanes(pass, blending));
      draw(pass, blending, indices, count, test::ListedVertices<4>{&over}, test::MixedColour{});
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
      draw_in_lanes(pass, {}, indices, 5, test::ListedVertices<4>{&vertices}, test::MixedColour{},
                    test::mixed_stages(isa));
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
                      test::ListedVertices<4>{vertices}, test::MixedColour{},
                      test::mixed_stages(isa));
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
      draw(pass, {}, indices, count, stage, test::MixedColour{});
    } else {
      draw_in_lanes(pass, {}, indices, count, stage, test::MixedColour{}, test::mixed_stages(isa));
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
