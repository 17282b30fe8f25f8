#include "raster/pipeline/merge.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::same_bits;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
DrawState with_depth(Compare test, bool write = true) {
  DrawState state;
  state.depth = DepthState{test, write};
  return state;
}

glm::vec4 written(const ColourState& state, Format format, glm::vec4 before, glm::vec4 colour,
                  const Profile& profile = {}) {
  Image target = make_image(format, 1, 1);
  store_texel(target, 0, 0, before, {});
  write_colour(state, target, 0, 0, colour, profile);
  return load_texel(target, 0, 0);
}

ColourState blending(BlendEquation colour, BlendEquation alpha) {
  ColourState state;
  state.blend = BlendState{colour, alpha};
  return state;
}

constexpr BlendEquation kOver{BlendFactor::source_alpha, BlendFactor::one_minus_source_alpha,
                              BlendOp::add};

}  // namespace

TEST_CASE("every blend factor and operation is the written-out formula, colour and alpha apart") {
  const glm::vec4 s{0.3f, -0.7f, 1.6f, 0.4f};
  const glm::vec4 d{0.9f, 0.2f, 0.55f, 0.15f};
  struct Factor {
    BlendFactor kind;
    glm::vec4 value;
  };
  const std::array<Factor, 10> factors{{
      {BlendFactor::zero, {0.0f, 0.0f, 0.0f, 0.0f}},
      {BlendFactor::one, {1.0f, 1.0f, 1.0f, 1.0f}},
      {BlendFactor::source_colour, {0.3f, -0.7f, 1.6f, 0.4f}},
      {BlendFactor::one_minus_source_colour, {1 - 0.3f, 1 + 0.7f, 1 - 1.6f, 1 - 0.4f}},
      {BlendFactor::destination_colour, {0.9f, 0.2f, 0.55f, 0.15f}},
      {BlendFactor::one_minus_destination_colour, {1 - 0.9f, 1 - 0.2f, 1 - 0.55f, 1 - 0.15f}},
      {BlendFactor::source_alpha, {0.4f, 0.4f, 0.4f, 0.4f}},
      {BlendFactor::one_minus_source_alpha, {1 - 0.4f, 1 - 0.4f, 1 - 0.4f, 1 - 0.4f}},
      {BlendFactor::destination_alpha, {0.15f, 0.15f, 0.15f, 0.15f}},
      {BlendFactor::one_minus_destination_alpha, {1 - 0.15f, 1 - 0.15f, 1 - 0.15f, 1 - 0.15f}},
  }};
  const auto wanted_value = [&](BlendOp op, const Factor& fs, const Factor& fd, int i) {
    const float a = s[i] * fs.value[i];
    const float b = d[i] * fd.value[i];
    switch (op) {
      case BlendOp::add: return a + b;
      case BlendOp::subtract: return a - b;
      case BlendOp::reverse_subtract: return b - a;
      case BlendOp::minimum: return std::min(s[i], d[i]);
      case BlendOp::maximum: return std::max(s[i], d[i]);
    }
    return kNan;
  };
  int wrong = 0;
  for (const BlendOp op : {BlendOp::add, BlendOp::subtract, BlendOp::reverse_subtract,
                           BlendOp::minimum, BlendOp::maximum}) {
    for (std::size_t i = 0; i < factors.size(); ++i) {
      for (std::size_t j = 0; j < factors.size(); ++j) {
        // Another equation for the alpha, so that neither can leak into the other.
        const Factor& alpha_source = factors[(i + 3) % 10];
        const Factor& alpha_destination = factors[(j + 7) % 10];
        const BlendOp alpha_op = op == BlendOp::add ? BlendOp::subtract : BlendOp::add;
        const glm::vec4 result = blend({{factors[i].kind, factors[j].kind, op},
                                        {alpha_source.kind, alpha_destination.kind, alpha_op}},
                                       s, d);
        const glm::vec4 expected{wanted_value(op, factors[i], factors[j], 0),
                                 wanted_value(op, factors[i], factors[j], 1),
                                 wanted_value(op, factors[i], factors[j], 2),
                                 wanted_value(alpha_op, alpha_source, alpha_destination, 3)};
        wrong += result != expected;
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("without blending the source replaces what was there") {
  CHECK(same_bits(written({}, Format::rgba32f, glm::vec4{9.0f}, {1.0f, -2.0f, 3.0f, 0.5f}),
                  {1.0f, -2.0f, 3.0f, 0.5f}));
}

TEST_CASE("blending reads the target decoded and stores it encoded, in every format") {
  const glm::vec4 before{0.25f, 0.5f, 0.75f, 1.0f};
  const glm::vec4 colour{1.0f, 0.0f, 0.5f, 0.5f};
  for (const Format format :
       {Format::r8, Format::rgba8, Format::srgb8, Format::rgba16f, Format::r32f, Format::rgba32f}) {
    Image target = make_image(format, 1, 1);
    store_texel(target, 0, 0, before, {});
    const glm::vec4 stored = load_texel(target, 0, 0);
    write_colour(blending(kOver, kOver), target, 0, 0, colour, {});
    Image expected = make_image(format, 1, 1);
    store_texel(expected, 0, 0, colour * 0.5f + stored * 0.5f, {});
    CHECK(equal(target, expected));
  }
}

TEST_CASE("a one-channel target blends with a destination alpha of 1") {
  const BlendEquation by_alpha{BlendFactor::destination_alpha, BlendFactor::zero, BlendOp::add};
  CHECK(written(blending(by_alpha, by_alpha), Format::r32f, glm::vec4{0.5f}, glm::vec4{0.3f}).x ==
        0.3f);
}

TEST_CASE("a colour mask keeps the stored channels that it leaves out") {
  const glm::vec4 before{0.1f, 0.2f, 0.3f, 0.4f};
  const glm::vec4 colour{1.0f, 2.0f, 3.0f, 4.0f};
  for (int mask = 0; mask < 16; ++mask) {
    ColourState state;
    glm::vec4 expected = before;
    for (int i = 0; i < 4; ++i) {
      state.write[static_cast<std::size_t>(i)] = (mask >> i & 1) != 0;
      if ((mask >> i & 1) != 0) expected[i] = colour[i];
    }
    CHECK(same_bits(written(state, Format::rgba32f, before, colour), expected));
  }
}

TEST_CASE("a colour mask holds after blending, too") {
  const BlendEquation add{BlendFactor::one, BlendFactor::one, BlendOp::add};
  ColourState state = blending(add, add);
  state.write = {true, false, true, false};
  CHECK(same_bits(written(state, Format::rgba32f, glm::vec4{1.0f}, glm::vec4{2.0f}),
                  {3.0f, 1.0f, 3.0f, 1.0f}));
}

TEST_CASE("what a colour mask leaves out of an 8-bit, sRGB or half target keeps its bits") {
  int wrong = 0;
  ColourState state;
  state.write = {false, false, false, true};
  for (const Format format : {Format::rgba8, Format::srgb8}) {
    for (int k = 0; k < 256; ++k) {
      Image target = make_image(format, 1, 1);
      auto texel = row<std::uint8_t>(target, 0);
      texel[0] = texel[1] = texel[2] = static_cast<std::uint8_t>(k);
      write_colour(state, target, 0, 0, glm::vec4{1.0f}, {});
      wrong += texel[0] != k || texel[1] != k || texel[2] != k || texel[3] != 255;
    }
  }
  for (int k = 0; k <= 0xFFFF; ++k) {
    if ((k & 0x7FFF) > 0x7C00) continue;
    Image target = make_image(Format::rgba16f, 1, 1);
    row<std::uint16_t>(target, 0)[1] = static_cast<std::uint16_t>(k);
    write_colour(state, target, 0, 0, glm::vec4{1.0f}, profile_named("d3d11"));
    wrong += row<std::uint16_t>(target, 0)[1] != k;
  }
  CHECK(wrong == 0);
}

TEST_CASE("blending into half targets rounds once, as the profile stores") {
  const BlendEquation add{BlendFactor::one, BlendFactor::one, BlendOp::add};
  const glm::vec4 small{0.75f / 1024.0f};
  CHECK(written(blending(add, add), Format::rgba16f, glm::vec4{1.0f}, small).x ==
        1.0f + 1.0f / 1024.0f);
  CHECK(written(blending(add, add), Format::rgba16f, glm::vec4{1.0f}, small, profile_named("d3d11"))
            .x == 1.0f);
}

// --- through the draw call ---

namespace {

// Discards the left half; counts nothing, writes white.
struct DiscardLeft {
  static constexpr std::array<Interpolation, 0> kInterpolation{};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = true;
  FragmentOutput<1> operator()(const Fragment<0>& f) const { return {{glm::vec4{1.0f}}, f.x < 4}; }
};

// Says that it discards everything, but has not declared that it may.
struct UndeclaredDiscard {
  static constexpr std::array<Interpolation, 0> kInterpolation{};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<0>&) const { return {{glm::vec4{1.0f}}, true}; }
};

struct Buffers {
  Image colour = make_image(Format::rgba32f, 8, 8);
  Image depth = make_image(Format::r32f, 8, 8);
  Image stencil = make_image(Format::r8, 8, 8);
  Buffers() { clear_image(depth, glm::vec4{1.0f}, {}); }
  RenderTargets targets() { return {.colour = {&colour}, .depth = &depth, .stencil = &stencil}; }
};

}  // namespace

TEST_CASE("a discarded fragment writes neither colour nor depth nor stencil") {
  Buffers buffers;
  DrawState state = with_depth(Compare::less);
  state.cull = Cull::none;
  state.stencil.emplace();
  state.stencil->front.on_pass = state.stencil->back.on_pass = StencilOp::increment_clamp;
  test::draw_list(buffers.targets(), state, test::covering_quad(8, 8), DiscardLeft{});
  int wrong = 0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool kept = x >= 4;
      wrong += load_texel(buffers.colour, x, y).x != (kept ? 1.0f : 0.0f);
      wrong += load_texel(buffers.depth, x, y).x != (kept ? 0.5f : 1.0f);
      wrong += row<std::uint8_t>(buffers.stencil, y)[static_cast<std::size_t>(x)] != (kept ? 1 : 0);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a stage that may discard is still tested: late is as good as early") {
  Buffers buffers;
  clear_image(buffers.depth, glm::vec4{0.25f}, {});  // nearer than the quad
  DrawState state = with_depth(Compare::less);
  state.cull = Cull::none;
  state.stencil.emplace();
  state.stencil->front.on_depth_fail = state.stencil->back.on_depth_fail = StencilOp::replace;
  state.stencil->front.reference = state.stencil->back.reference = 5;
  test::draw_list(buffers.targets(), state, test::covering_quad(8, 8), DiscardLeft{});
  CHECK(load_texel(buffers.colour, 6, 3).x == 0.0f);
  CHECK(load_texel(buffers.depth, 6, 3).x == 0.25f);
  CHECK(row<std::uint8_t>(buffers.stencil, 3)[6] == 5);
  CHECK(row<std::uint8_t>(buffers.stencil, 3)[2] == 0);  // discarded before the test
}

TEST_CASE("a discard that the stage has not declared is no discard") {
  Buffers buffers;
  test::draw_list(buffers.targets(), test::plain_state(), test::covering_quad(8, 8),
                  UndeclaredDiscard{});
  CHECK(load_texel(buffers.colour, 2, 2).x == 1.0f);
}

TEST_CASE("of two surfaces the nearer is seen, whichever is drawn first") {
  for (const bool near_first : {true, false}) {
    Buffers buffers;
    DrawState state = with_depth(Compare::less);
    state.cull = Cull::none;
    for (const bool near : {near_first, !near_first}) {
      test::draw_list(buffers.targets(), state, test::covering_quad(8, 8, near ? 0.25f : 0.75f),
                      test::OneColour{glm::vec4{near ? 1.0f : 2.0f}});
    }
    CHECK(load_texel(buffers.colour, 3, 3).x == 1.0f);
    CHECK(load_texel(buffers.depth, 3, 3).x == 0.25f);
  }
}

TEST_CASE("a stencil mask drawn first lets the second draw through where it lies") {
  Buffers buffers;
  DrawState mark = test::plain_state();
  mark.stencil.emplace();
  mark.stencil->front = mark.stencil->back = {.reference = 1, .on_pass = StencilOp::replace};
  mark.colour[0].write = {false, false, false, false};
  test::draw_list(buffers.targets(), mark,
                  test::window_triangles(test::window_quad(2, 2, 6, 5), 8, 8), test::OneColour{});
  DrawState fill = test::plain_state();
  fill.stencil.emplace();
  fill.stencil->front = fill.stencil->back = {.test = Compare::equal, .reference = 1};
  test::draw_list(buffers.targets(), fill, test::covering_quad(8, 8), test::OneColour{});
  int wrong = 0;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool marked = x >= 2 && x < 6 && y >= 2 && y < 5;
      wrong += load_texel(buffers.colour, x, y) != glm::vec4{marked ? 1.0f : 0.0f};
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("blending into a normalised format clamps the source to 0..1 first") {
  Image target = make_image(Format::rgba8, 1, 1);
  ColourState state;
  state.blend = BlendState{{BlendFactor::one, BlendFactor::one, BlendOp::subtract},
                           {BlendFactor::one, BlendFactor::one, BlendOp::subtract}};
  store_texel(target, 0, 0, {0.2f, 0.2f, 0.2f, 0.2f}, Profile{});
  // 3 counts as 1, -1 and NaN as 0.
  write_colour(state, target, 0, 0, {3.0f, -1.0f, kNan, 1.0f}, Profile{});
  const auto texel = row<std::uint8_t>(target, 0);
  CHECK(texel[0] == 204);
  CHECK(texel[1] == 0);
  CHECK(texel[2] == 0);
  CHECK(texel[3] == 204);
}

TEST_CASE("a NaN's payload survives in a channel that is masked out") {
  Image target = make_image(Format::rgba16f, 1, 1);
  const auto texel = row<std::uint16_t>(target, 0);
  texel[1] = 0x7D55;
  ColourState state;
  state.write = {true, false, true, true};
  write_colour(state, target, 0, 0, {1.0f, 1.0f, 1.0f, 1.0f}, Profile{});
  CHECK(texel[0] == kHalfOne);
  CHECK(texel[1] == 0x7D55);
  CHECK(texel[2] == kHalfOne);
}
