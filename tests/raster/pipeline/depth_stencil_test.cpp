#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "raster/pipeline/merge.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

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
