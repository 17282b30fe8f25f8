#include "raster/pipeline/merge.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "tests/raster_helpers.h"

using namespace softfocus;
using test::profile_named;
using test::same_bits;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::array kCompares{Compare::never,         Compare::less,    Compare::equal,
                               Compare::less_equal,    Compare::greater, Compare::not_equal,
                               Compare::greater_equal, Compare::always};
constexpr std::array kStencilOps{StencilOp::keep,
                                 StencilOp::zero,
                                 StencilOp::replace,
                                 StencilOp::increment_clamp,
                                 StencilOp::decrement_clamp,
                                 StencilOp::invert,
                                 StencilOp::increment_wrap,
                                 StencilOp::decrement_wrap};

// Whether the comparison holds, by what its name says of smaller, equal and larger.
struct Truth {
  Compare function;
  bool smaller, equal, larger;
};
constexpr std::array kTruths{
    Truth{Compare::never, false, false, false},       Truth{Compare::less, true, false, false},
    Truth{Compare::equal, false, true, false},        Truth{Compare::less_equal, true, true, false},
    Truth{Compare::greater, false, false, true},      Truth{Compare::not_equal, true, false, true},
    Truth{Compare::greater_equal, false, true, true}, Truth{Compare::always, true, true, true}};

// One pixel with a depth and a stencil buffer.
struct Pixel {
  Image depth = make_image(Format::r32f, 1, 1);
  Image stencil = make_image(Format::r8, 1, 1);

  Pixel(float d, int s) {
    row<float>(depth, 0)[0] = d;
    row<std::uint8_t>(stencil, 0)[0] = static_cast<std::uint8_t>(s);
  }
  RenderTargets targets() { return {.depth = &depth, .stencil = &stencil}; }
  bool test(const DrawState& state, float d, bool front = true) {
    return depth_stencil_test(state, targets(), 0, 0, d, front);
  }
  float d() const { return row<float>(depth, 0)[0]; }
  int s() const { return row<std::uint8_t>(stencil, 0)[0]; }
};

DrawState with_depth(Compare test, bool write = true) {
  DrawState state;
  state.depth = DepthState{test, write};
  return state;
}

int wanted(StencilOp op, int reference, int stored) {
  switch (op) {
    case StencilOp::keep: return stored;
    case StencilOp::zero: return 0;
    case StencilOp::replace: return reference;
    case StencilOp::increment_clamp: return std::min(stored + 1, 255);
    case StencilOp::decrement_clamp: return std::max(stored - 1, 0);
    case StencilOp::invert: return 255 - stored;
    case StencilOp::increment_wrap: return (stored + 1) % 256;
    case StencilOp::decrement_wrap: return (stored + 255) % 256;
  }
  return -1;
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

TEST_CASE("every compare function says of smaller, equal and larger what its name says") {
  for (const Truth& truth : kTruths) {
    CHECK(compare(truth.function, 1.0f, 2.0f) == truth.smaller);
    CHECK(compare(truth.function, 2.0f, 2.0f) == truth.equal);
    CHECK(compare(truth.function, 3.0f, 2.0f) == truth.larger);
    CHECK(compare<std::uint8_t>(truth.function, 1, 2) == truth.smaller);
    CHECK(compare<std::uint8_t>(truth.function, 2, 2) == truth.equal);
    CHECK(compare<std::uint8_t>(truth.function, 255, 2) == truth.larger);
  }
}

TEST_CASE("a comparison with NaN fails, but for not-equal and always") {
  for (const Compare function : kCompares) {
    const bool holds = function == Compare::not_equal || function == Compare::always;
    CHECK(compare(function, kNan, 0.5f) == holds);
    CHECK(compare(function, 0.5f, kNan) == holds);
  }
}

TEST_CASE("the depth test compares the incoming with the stored depth, in this order") {
  for (const Truth& truth : kTruths) {
    CHECK(Pixel{0.5f, 0}.test(with_depth(truth.function), 0.25f) == truth.smaller);
    CHECK(Pixel{0.5f, 0}.test(with_depth(truth.function), 0.5f) == truth.equal);
    CHECK(Pixel{0.5f, 0}.test(with_depth(truth.function), 0.75f) == truth.larger);
  }
}

TEST_CASE("depth is written where the test passes and writing is on, and only there") {
  for (const bool write : {true, false}) {
    for (const float depth : {0.25f, 0.75f}) {
      Pixel pixel{0.5f, 0};
      const bool passes = pixel.test(with_depth(Compare::less, write), depth);
      CHECK(passes == (depth < 0.5f));
      CHECK(pixel.d() == (passes && write ? depth : 0.5f));
    }
  }
}

TEST_CASE("without depth state or depth buffer every fragment passes and nothing is written") {
  Pixel pixel{0.5f, 7};
  DrawState state;
  state.depth.reset();
  CHECK(pixel.test(state, 0.9f));
  CHECK(pixel.d() == 0.5f);
  CHECK(depth_stencil_test(with_depth(Compare::never), {}, 0, 0, 0.9f, true));
}

TEST_CASE("every stencil operation makes of every value what its name says") {
  int wrong = 0;
  for (const StencilOp op : kStencilOps) {
    for (int stored = 0; stored < 256; ++stored) {
      const StencilFace face{.reference = 77};
      wrong += apply(op, face, static_cast<std::uint8_t>(stored)) != wanted(op, 77, stored);
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("the write mask keeps the stored bits that it leaves out, for every operation") {
  int wrong = 0;
  for (const StencilOp op : kStencilOps) {
    for (const int mask : {0x00, 0x01, 0x0F, 0xF0, 0xA5, 0xFF}) {
      for (int stored = 0; stored < 256; ++stored) {
        DrawState state;
        state.depth.reset();
        state.stencil.emplace();
        state.stencil->front = {
            .reference = 0x3C, .write_mask = static_cast<std::uint8_t>(mask), .on_pass = op};
        Pixel pixel{0.5f, stored};
        pixel.test(state, 0.5f);
        wrong += pixel.s() != ((wanted(op, 0x3C, stored) & mask) | (stored & ~mask & 0xFF));
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE(
    "the stencil test compares the reference with the stored value, both under the read mask") {
  int wrong = 0;
  for (const Truth& truth : kTruths) {
    for (const int mask : {0x00, 0x0F, 0xF0, 0xFF}) {
      for (int stored = 0; stored < 256; stored += 5) {
        for (int reference = 0; reference < 256; reference += 7) {
          DrawState state;
          state.depth.reset();
          state.stencil.emplace();
          state.stencil->front = {.test = truth.function,
                                  .reference = static_cast<std::uint8_t>(reference),
                                  .read_mask = static_cast<std::uint8_t>(mask)};
          const int a = reference & mask;
          const int b = stored & mask;
          const bool expected = a < b ? truth.smaller : a == b ? truth.equal : truth.larger;
          wrong += Pixel{0.5f, stored}.test(state, 0.5f) != expected;
        }
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("stencil first, then depth: each outcome runs its own operation") {
  DrawState state = with_depth(Compare::less);
  state.stencil.emplace();
  const auto outcome = [&](Compare stencil, float depth) {
    state.stencil->front = {.test = stencil,
                            .reference = 9,
                            .on_fail = StencilOp::zero,
                            .on_depth_fail = StencilOp::invert,
                            .on_pass = StencilOp::replace};
    Pixel pixel{0.5f, 100};
    const bool passes = pixel.test(state, depth);
    return std::tuple{passes, pixel.s(), pixel.d()};
  };
  CHECK(outcome(Compare::never, 0.25f) == std::tuple{false, 0, 0.5f});
  CHECK(outcome(Compare::never, 0.75f) == std::tuple{false, 0, 0.5f});
  CHECK(outcome(Compare::always, 0.75f) == std::tuple{false, 155, 0.5f});
  CHECK(outcome(Compare::always, 0.25f) == std::tuple{true, 9, 0.25f});
}

TEST_CASE("without a depth test the stencil's pass operation runs") {
  DrawState state;
  state.depth.reset();
  state.stencil.emplace();
  state.stencil->front = {.on_depth_fail = StencilOp::zero, .on_pass = StencilOp::increment_wrap};
  Pixel pixel{0.5f, 255};
  CHECK(pixel.test(state, 0.9f));
  CHECK(pixel.s() == 0);
}

TEST_CASE("front and back faces have their own stencil state") {
  DrawState state;
  state.depth.reset();
  state.stencil.emplace();
  state.stencil->front = {.reference = 1, .on_pass = StencilOp::replace};
  state.stencil->back = {.test = Compare::never, .on_fail = StencilOp::decrement_wrap};
  Pixel pixel{0.5f, 50};
  CHECK(pixel.test(state, 0.5f, true));
  CHECK(pixel.s() == 1);
  CHECK_FALSE(pixel.test(state, 0.5f, false));
  CHECK_FALSE(pixel.test(state, 0.5f, false));
  CHECK(pixel.s() == 255);
}

TEST_CASE("a stencil state without a stencil buffer passes and leaves the depth test to decide") {
  DrawState state = with_depth(Compare::less);
  state.stencil.emplace();
  state.stencil->front.test = Compare::never;
  Pixel pixel{0.5f, 0};
  CHECK(depth_stencil_test(state, {.depth = &pixel.depth}, 0, 0, 0.25f, true));
  CHECK_FALSE(depth_stencil_test(state, {.depth = &pixel.depth}, 0, 0, 0.75f, true));
}

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
  store_texel(target, 0, 0, {0.2f, 0.2f, 0.2f, 0.2f}, profiles()[0]);
  // 3 counts as 1, -1 and NaN as 0.
  write_colour(state, target, 0, 0, {3.0f, -1.0f, kNan, 1.0f}, profiles()[0]);
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
  write_colour(state, target, 0, 0, {1.0f, 1.0f, 1.0f, 1.0f}, profiles()[0]);
  CHECK(texel[0] == kHalfOne);
  CHECK(texel[1] == 0x7D55);
  CHECK(texel[2] == kHalfOne);
}
